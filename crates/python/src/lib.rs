//! The extension module `hc._native`, under the Python packages `hc` and `tdoa`.
//!
//! It turns arrays into what the libraries take and results into arrays; all else, such as pictures
//! and representations, is Python. Work runs beside the interpreter ([`work`]), errors keep the
//! words of the libraries ([`errors`]).

mod arrays;
mod calibration;
mod certify;
mod clocks;
mod decompose;
mod errors;
mod family;
mod json;
mod listen;
mod measured;
mod networks;
mod solve;
mod system;
mod work;

#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use crate::calibration::{
        calibrate, calibration_compared, calibration_html, calibration_located, calibration_nodes, calibration_style,
        calibration_summary, calibration_svg,
    };
    #[pymodule_export]
    use crate::certify::{certify, mixed_volume};
    #[pymodule_export]
    use crate::decompose::decompose;
    #[pymodule_export]
    use crate::family::{Family, Fibre};
    #[pymodule_export]
    use crate::listen::{listen, speed_of_sound, write_recording};
    #[pymodule_export]
    use crate::measured::{check_size, heads_list, read};
    #[pymodule_export]
    use crate::networks::{cramer_rao, simulate, solve_network};
    #[pymodule_export]
    use crate::solve::solve;

    #[pymodule_init]
    fn init(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        pyo3::types::PyModuleMethods::add(module, "FORMAT", crate::json::FORMAT)?;
        pyo3::types::PyModuleMethods::add(module, "__version__", env!("CARGO_PKG_VERSION"))
    }
}
