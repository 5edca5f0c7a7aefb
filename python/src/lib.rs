//! The Python package `hamel`: the part of it that is compiled. What users see of it stands in `package/hamel`; its types are in `_hamel.pyi`.

mod arguments;
mod batch;
mod compile;
mod dynamics;
mod equations;
mod errors;
mod info;
mod inputs;
mod joint;
mod joint_source;
mod joint_values;
mod level;
mod load;
mod pictures;
mod positions;
mod program;
mod results;
mod robot;
mod simulation;
mod source;
mod sweep;
mod workspace;

use pyo3::prelude::*;

/// Compiled part of `hamel`.
#[pymodule]
mod _hamel {
    #[pymodule_export]
    use crate::batch::set_threads;
    #[pymodule_export]
    use crate::joint::Joint;
    #[pymodule_export]
    use crate::level::{arithmetic, levels};
    #[pymodule_export]
    use crate::load::{load, parse};
    #[pymodule_export]
    use crate::pictures::{page, picture};
    #[pymodule_export]
    use crate::program::run_program;
    #[pymodule_export]
    use crate::robot::Robot;
    #[pymodule_export]
    use crate::simulation::simulate;
    #[pymodule_export]
    use crate::sweep::{Sweep, sample, scene_text};
}
