//! Choices of options of the command line.

use clap::ValueEnum;
use proboscis::app::RunIn;
use proboscis::report::viewpoint::Viewpoint;

/// Returns the engine of several solves.
pub(crate) const fn run_in(processes: bool) -> RunIn {
    match processes {
        true => RunIn::Processes,
        false => RunIn::Threads,
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum View {
    /// View from the front, right and above.
    Oblique,
    /// Along the z axis, y upwards.
    Front,
    /// Along the x axis, y upwards.
    Side,
    /// Along the y axis, from above.
    Top,
    /// In the direction in which motion and shape of the system together are smallest.
    Auto,
}

impl View {
    pub(crate) const fn viewpoint(self) -> Viewpoint {
        match self {
            Self::Oblique => Viewpoint::Oblique,
            Self::Front => Viewpoint::Front,
            Self::Side => Viewpoint::Side,
            Self::Top => Viewpoint::Top,
            Self::Auto => Viewpoint::Auto,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Export {
    /// motion.gltf: an animation of bodies, muscles, markers and elastic blocks, for Blender and other programs.
    Gltf,
    /// parts.pvd: bodies, muscles and markers for ParaView; elastic blocks always have such files.
    Paraview,
}
