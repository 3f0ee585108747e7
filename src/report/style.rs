//! The one look of figures and pages: fonts, sizes, colours.

/// An opaque colour: red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

/// Font of all figures.
pub const FONT: &str = "Helvetica, Arial, Liberation Sans, sans-serif";
/// Size of axis labels in pt.
pub const LABEL_SIZE: f64 = 11.0;
/// Size of tick labels and legends in pt.
pub const TICK_SIZE: f64 = 9.5;
/// Size of labels next to points of a curve in pt.
pub const LABEL_OF_POINT_SIZE: f64 = 7.5;
/// Size of the caption that names the origin in pt.
pub const CAPTION_SIZE: f64 = 6.5;
/// Width of a curve in pt.
pub const CURVE: f64 = 1.6;
/// Dash and gap of an antagonist in pt.
pub const DASH: [f64; 2] = [5.0, 3.0];

/// Text and axes.
pub const INK: Colour = Colour(0x22, 0x26, 0x2b);
/// Captions and what stands back.
pub const MUTED: Colour = Colour(0x8a, 0x90, 0x98);
/// Grid lines.
pub const GRID: Colour = Colour(0xe6, 0xe8, 0xeb);
/// Paper.
pub const PAPER: Colour = Colour(0xff, 0xff, 0xff);
/// Rigid bodies.
pub const BODY: Colour = Colour(0x6f, 0x8f, 0xb0);
/// Elastic blocks without potentials.
pub const PASSIVE: Colour = Colour(0xd9, 0xcf, 0xbc);
/// Springs and tendons.
pub const TIE: Colour = Colour(0x8a, 0x5a, 0x2b);
/// Springs and tendons on a page, light or dark.
pub const TIE_ON_PAGE: Colour = Colour(0xa0, 0x6a, 0x35);
/// The initial configuration.
pub const REFERENCE: Colour = Colour(0xc4, 0xc8, 0xcd);

/// Hues of Okabe and Ito that stand on white, distinguishable with any colour vision.
const HUES: [Colour; 6] = [
    Colour(0x00, 0x72, 0xb2),
    Colour(0xd5, 0x5e, 0x00),
    Colour(0x00, 0x9e, 0x73),
    Colour(0xcc, 0x79, 0xa7),
    Colour(0xe6, 0x9f, 0x00),
    Colour(0x56, 0xb4, 0xe9),
];

/// Stops of the map `magma` of matplotlib, perceptually uniform, at equal distances: from its light end,
/// for a muscle at rest, to where it would turn dark.
const MAGMA: [Colour; 7] = [
    Colour(0xfc, 0xfd, 0xbf),
    Colour(0xfe, 0xcf, 0x92),
    Colour(0xfe, 0x9f, 0x6d),
    Colour(0xf7, 0x70, 0x5c),
    Colour(0xde, 0x49, 0x68),
    Colour(0xb7, 0x37, 0x79),
    Colour(0x8c, 0x29, 0x81),
];

impl Colour {
    /// `(1 − t)` of this colour and `t` of the other.
    pub fn mix(self, other: Self, t: f64) -> Self {
        let channel = |a: u8, b: u8| (f64::from(a) * (1.0 - t) + f64::from(b) * t).round() as u8;
        Self(
            channel(self.0, other.0),
            channel(self.1, other.1),
            channel(self.2, other.2),
        )
    }

    /// The colour as `#rrggbb`.
    pub fn hex(self) -> String {
        format!("#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

/// Pattern of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dash {
    /// Without gaps: agonists.
    Solid,
    /// With gaps: antagonists.
    Dashed,
}

/// Colour of the `i`-th of many alike (bodies, joints, curves): six hues, then darker, then lighter.
pub fn hue(i: usize) -> Colour {
    let colour = HUES[i % HUES.len()];
    match (i / HUES.len()) % 4 {
        0 => colour,
        1 => colour.mix(INK, 0.45),
        2 => colour.mix(PAPER, 0.45),
        _ => colour.mix(INK, 0.75),
    }
}

/// Colour and dash of muscle or source `i`, counted from zero: the pair at a joint shares a hue;
/// agonists (muscles 1, 3, …) are solid, antagonists (muscles 2, 4, …) dashed.
pub fn muscle(i: usize) -> (Colour, Dash) {
    let dash = if i.is_multiple_of(2) {
        Dash::Solid
    } else {
        Dash::Dashed
    };
    (hue(i / 2), dash)
}

/// Colour of a voltage as a fraction of the full scale; clamped to [0, 1].
pub fn voltage(fraction: f64) -> Colour {
    let place = fraction.clamp(0.0, 1.0) * (MAGMA.len() - 1) as f64;
    let below = (place as usize).min(MAGMA.len() - 2);
    MAGMA[below].mix(MAGMA[below + 1], place - below as f64)
}

/// Full scale of a voltage colour bar in V: the next round number above the highest voltage.
pub fn voltage_scale<'a>(voltages: impl IntoIterator<Item = &'a [f64]>) -> f64 {
    let highest = voltages
        .into_iter()
        .flatten()
        .filter(|v| v.is_finite())
        .fold(0.0, |a: f64, v| a.max(v.abs()));
    if highest == 0.0 {
        return 1000.0;
    }
    let step = 10_f64.powf(highest.log10().floor()) / 2.0;
    // A bound that the solver relaxed a little does not open the next step.
    (highest / step - 1e-4).ceil() * step
}
