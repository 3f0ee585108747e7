//! Coarsening along one axis: every other plane stays, and the last one; values between are interpolated.

/// Largest ratio of spacings at which an axis becomes coarser together with the one of the shortest spacing.
const EVEN: f64 = 1.7;

/// Transfer between the planes of one axis and those of a coarser grid.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    /// Planes that stay.
    pub(super) kept: Vec<usize>,
    /// Coarse planes from which each plane is interpolated, with weights; a weight of zero where there is one alone.
    pub(super) parents: Vec<[(usize, f32); 2]>,
    /// Planes to which each coarse plane contributes.
    pub(super) children: Vec<Vec<(usize, f32)>>,
}

impl Axis {
    /// Of these planes, every other one of which stays, or all.
    fn new(planes: &[f64], is_coarser: bool) -> Self {
        let last = planes.len() - 1;
        let mut kept: Vec<usize> = (0..=last).step_by(if is_coarser { 2 } else { 1 }).collect();
        if kept.last() != Some(&last) {
            kept.push(last);
        }
        let parents = (0..=last).map(|plane| {
            let after = kept.partition_point(|&k| k < plane);
            if kept[after] == plane {
                return [(after, 1.0), (after, 0.0)];
            }
            let [below, above] = [kept[after - 1], kept[after]].map(|k| planes[k]);
            let part = ((planes[plane] - below) / (above - below)) as f32;
            [(after - 1, 1.0 - part), (after, part)]
        });
        let parents: Vec<_> = parents.collect();
        let mut children = vec![Vec::new(); kept.len()];
        for (plane, of) in parents.iter().enumerate() {
            for &(coarse, weight) in of.iter().filter(|(_, weight)| *weight > 0.0) {
                children[coarse].push((plane, weight));
            }
        }
        Self {
            kept,
            parents,
            children,
        }
    }
}

/// Transfers to the next coarser grid; `None` where no axis can become coarser.
pub(super) fn coarsening(planes: &[Vec<f64>; 3]) -> Option<[Axis; 3]> {
    let spacing = |planes: &Vec<f64>| {
        let spans = (planes.len() - 1) as f64;
        (planes.len() > 2).then(|| (planes[planes.len() - 1] - planes[0]) / spans)
    };
    let spacings = planes.each_ref().map(spacing);
    let shortest = spacings.iter().flatten().copied().reduce(f64::min)?;
    let is_coarser = |axis: usize| spacings[axis].is_some_and(|s| s < EVEN * shortest);
    Some([0, 1, 2].map(|axis| Axis::new(&planes[axis], is_coarser(axis))))
}
