//! The compiled half of the Python package `undrift`: functions on arrays and files that release the
//! interpreter's lock. The classes that people see are in `python/undrift`.

use pyo3::pymodule;

mod allan;
mod arma;
mod array;
mod columns;
mod drive;
mod error;
mod filter;
mod fleet;
mod identify;
mod inspect;
mod model;
mod navigate;
mod navigator;
mod orders;
mod report;
mod simulate;
mod stationarity;
mod statistics;
mod tune;
mod work;

#[pymodule]
mod _undrift {
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "so it is called in Python")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
    #[pymodule_export]
    use crate::{
        allan::{
            allan_deviation, allan_gauss_markov, allan_terms, allan_terms_variance,
            wavelet_variance,
        },
        arma::{
            ar_burg, ar_order, ar_yule_walker, arma_fit, arma_log_likelihood,
            arma_profile_interval, arma_residuals, arma_simulate,
        },
        drive::{Drive, parts_by_names},
        error::{UndriftError, in_python},
        filter::Filter,
        fleet::{
            FleetGathering, fleet_failed, fleet_fingerprint, fleet_inputs, fleet_jobs,
            fleet_lookups, fleet_process,
        },
        identify::{Identified, identify},
        inspect::inspect,
        model::NoiseModel,
        navigate::{navigate, outages},
        navigator::Navigator,
        orders::{arma_pandit_wu, arma_select},
        report::make,
        simulate::{simulate, simulate_poses, write_csv},
        stationarity::{adf, kpss, phillips_perron, verdict},
        statistics::{
            acf, detrend, jarque_bera, normality_tests, pacf, portmanteau, psd, spectral_lines,
        },
        tune::tune,
    };
}
