//! The settings of a scene with the options of the command line laid over them.

use super::args::{Args, ArithmeticName, FormName, MethodName, SamplingName};
use hamel::integrate::{Form, Method, Sampling, Scheme, StepControl};
use hamel::shown::Number;
use hamel_console::output::Failure;
use hamel_scene::{Arithmetic, Settings};

/// The settings that `args` and the scene's `settings` make together.
///
/// # Errors
/// A value out of range, or an accuracy that means nothing to the method chosen.
pub fn overridden(settings: &Settings, args: &Args) -> Result<Settings, Failure> {
    let t_end = args
        .t_end
        .map(|t_end| in_range("--t-end", t_end, t_end >= 0.0, "at least 0"));
    let sample_step = positive("--sample-step", args.sample_step)?;
    let form = args.form.map(|form| match form {
        FormName::Lagrangian => Form::Lagrangian,
        FormName::Hamiltonian => Form::Hamiltonian,
    });
    let arithmetic = args.arithmetic.map(|arithmetic| match arithmetic {
        ArithmeticName::Doubles => Arithmetic::Doubles,
        ArithmeticName::Refined => Arithmetic::Refined,
        ArithmeticName::Auto => Arithmetic::Auto,
    });
    let sampling = args.sampling.map(|sampling| match sampling {
        SamplingName::Landing => Sampling::Landing,
        SamplingName::Dense => Sampling::Dense,
    });
    let (method, chooses) = method(settings, args)?;
    let accuracy = accuracy_asked(settings, args, &method)?;
    Ok(Settings {
        t_end: t_end.transpose()?.unwrap_or(settings.t_end),
        method,
        chooses,
        accuracy,
        form: form.unwrap_or(settings.form),
        arithmetic: arithmetic.unwrap_or(settings.arithmetic),
        sample_step: sample_step.unwrap_or(settings.sample_step),
        sampling: sampling.unwrap_or(settings.sampling),
    })
}

/// The method named; or implied by an accuracy; or the scene's; and whether it is left open. The scene's accuracy stays where it fits.
fn method(settings: &Settings, args: &Args) -> Result<(Method, bool), Failure> {
    let dt = positive("--dt", args.dt)?;
    let tol = args.tol.map(|tol| tolerance("--tol", tol)).transpose()?;
    let scene = settings.method;
    let own = *scene.scheme();
    let (own_dt, own_tol) = accuracy(scene);
    let scheme = match (args.method, dt, tol) {
        // An accuracy is had by step control.
        (None, None, None)
            if args.accuracy.is_some() && own_tol.is_none() && !own.has_estimate() =>
        {
            return Ok((Method::dormand_prince(Settings::DEFAULT_TOL), true));
        }
        (None, None, None) if args.accuracy.is_none() || own_tol.is_some() => {
            return Ok((scene, settings.chooses));
        }
        (None, None, None) => own,
        (Some(MethodName::Auto), Some(_), _) => {
            return refuse("--dt means nothing to auto, whose accuracy is --tol".to_owned());
        }
        (Some(MethodName::Auto), None, tol) => {
            let tol = tol.or(own_tol).unwrap_or(Settings::DEFAULT_TOL);
            return Ok((Method::dormand_prince(tol), true));
        }
        (Some(MethodName::Scheme(named)), ..) => named,
        // An accuracy alone leaves the scene its method where the two go together.
        (None, Some(_), _) if own_dt.is_some() => own,
        (None, None, Some(_)) if own.has_estimate() && !settings.chooses => own,
        (None, Some(_), _) => Scheme::Rk4,
        (None, None, Some(tol)) => return Ok((Method::dormand_prince(tol), true)),
    };
    let alone = Settings::method_of(Some(scheme), None, None);
    let is_controlled = matches!(alone, Some(Method::Controlled { .. }))
        || own_tol.is_some() && own == scheme && !settings.chooses
        || args.accuracy.or(settings.accuracy).is_some();
    let (dt, tol) = match (dt, tol) {
        (None, None) if is_controlled && scheme.has_estimate() => {
            (None, own_tol.or(Some(Settings::DEFAULT_TOL)))
        }
        (None, None) => (own_dt, None),
        given => given,
    };
    let method = Settings::method_of(Some(scheme), dt, tol);
    let name = scheme.name();
    method.map_or_else(
        || {
            refuse(format!(
                "--tol means nothing to {name}, whose accuracy is --dt"
            ))
        },
        |method| Ok((method, false)),
    )
}

/// The step or the tolerance that the scene asks for.
const fn accuracy(scene: Method) -> (Option<f64>, Option<f64>) {
    match scene {
        Method::Fixed { dt, .. } => (Some(dt), None),
        Method::Controlled { control, .. } => (None, Some(control.tolerance)),
    }
}

/// The accuracy asked for: by an option, or by the scene unless an option says how long steps are.
fn accuracy_asked(
    settings: &Settings,
    args: &Args,
    method: &Method,
) -> Result<Option<f64>, Failure> {
    let asked = args.accuracy.map(|value| tolerance("--accuracy", value));
    let asked = asked.transpose()?;
    match (asked, method) {
        (Some(_), Method::Fixed { scheme, .. }) => refuse(format!(
            "--accuracy means nothing to {}, whose accuracy is --dt",
            scheme.name()
        )),
        (None, Method::Controlled { .. }) if args.tol.is_none() => Ok(settings.accuracy),
        _ => Ok(asked),
    }
}

fn tolerance(option: &str, tol: f64) -> Result<f64, Failure> {
    let (least, largest) = (StepControl::LEAST_TOLERANCE, StepControl::LARGEST_TOLERANCE);
    let limit = format!("between {:?} and {:?}", Number(least), Number(largest));
    in_range(option, tol, (least..=largest).contains(&tol), &limit)
}

fn positive(option: &str, value: Option<f64>) -> Result<Option<f64>, Failure> {
    value
        .map(|value| in_range(option, value, value > 0.0, "above 0"))
        .transpose()
}

fn in_range(option: &str, value: f64, holds: bool, limit: &str) -> Result<f64, Failure> {
    if holds && value.is_finite() {
        return Ok(value);
    }
    refuse(format!(
        "{option} is {:?}; it must be finite and {limit}",
        Number(value)
    ))
}

fn refuse<T>(message: String) -> Result<T, Failure> {
    Err(Failure::Options(message))
}

#[cfg(test)]
mod tests {
    use super::{Args, Method, Sampling, Scheme, Settings, overridden};
    use clap::Parser;

    #[derive(Parser)]
    struct Command {
        #[command(flatten)]
        args: Args,
    }

    fn settings(scene: Method, options: &str) -> Option<Settings> {
        let words = ["hamel", "scene.toml"]
            .into_iter()
            .chain(options.split_whitespace());
        let args = Command::try_parse_from(words).ok()?.args;
        let settings = Settings {
            method: scene,
            chooses: false,
            ..Settings::default()
        };
        overridden(&settings, &args).ok()
    }

    fn method(scene: Method, options: &str) -> Option<Method> {
        settings(scene, options).map(|settings| settings.method)
    }

    #[test]
    fn an_accuracy_implies_its_method_and_the_scene_fills_the_rest() {
        let (rk4, dopri5) = (Method::rk4(0.5), Method::dormand_prince(1e-5));
        let dop853 = Method::controlled(Scheme::DormandPrince8, 1e-12);
        let gauss = Method::fixed(Scheme::Gauss2, 0.5);
        let gradient = Method::fixed(Scheme::DiscreteGradient, 0.5);
        let gradient_to = |tol| Method::controlled(Scheme::DiscreteGradient, tol);
        let default_dt = Settings::DEFAULT_DT;
        for (scene, options, wanted) in [
            (rk4, "", rk4),
            (rk4, "--method rk4", rk4),
            (dopri5, "--method rk4", Method::rk4(default_dt)),
            (dopri5, "--dt 0.1", Method::rk4(0.1)),
            (rk4, "--tol 1e-6", Method::dormand_prince(1e-6)),
            (
                rk4,
                "--method dopri5",
                Method::dormand_prince(Settings::DEFAULT_TOL),
            ),
            (dopri5, "--method dopri5", dopri5),
            (
                dopri5,
                "--method dop853",
                Method::controlled(Scheme::DormandPrince8, 1e-5),
            ),
            (
                dop853,
                "--tol 1e-15",
                Method::controlled(Scheme::DormandPrince8, 1e-15),
            ),
            (dop853, "--dt 0.1", Method::rk4(0.1)),
            (gauss, "--dt 0.1", Method::fixed(Scheme::Gauss2, 0.1)),
            (gauss, "--tol 1e-7", Method::dormand_prince(1e-7)),
            (
                rk4,
                "--method dop853 --dt 0.1",
                Method::fixed(Scheme::DormandPrince8, 0.1),
            ),
            (
                rk4,
                "--method radau5 --tol 1e-7",
                Method::controlled(Scheme::Radau5, 1e-7),
            ),
            (
                dopri5,
                "--method discrete_gradient",
                Method::fixed(Scheme::DiscreteGradient, default_dt),
            ),
            (gradient, "--tol 1e-4", gradient_to(1e-4)),
            (
                gradient_to(1e-6),
                "--method discrete_gradient",
                gradient_to(1e-6),
            ),
            (
                gradient,
                "--accuracy 1e-3",
                gradient_to(Settings::DEFAULT_TOL),
            ),
            (
                gradient,
                "--method discrete_gradient --accuracy 1e-3",
                gradient_to(Settings::DEFAULT_TOL),
            ),
            (
                rk4,
                "--method dopri5 --tol 1e-7",
                Method::dormand_prince(1e-7),
            ),
        ] {
            assert_eq!(method(scene, options), Some(wanted), "{options}");
        }
    }

    #[test]
    fn the_choice_is_left_open_until_a_method_or_a_step_is_named() {
        let chooses = |chooses: bool, options: &str| {
            let words = ["hamel", "scene.toml"]
                .into_iter()
                .chain(options.split_whitespace());
            let args = Command::try_parse_from(words).ok()?.args;
            let scene = Settings {
                chooses,
                method: Method::dormand_prince(1e-7),
                ..Settings::default()
            };
            let found = overridden(&scene, &args).ok()?;
            Some((found.chooses, found.method))
        };
        let open = |tol| Some((true, Method::dormand_prince(tol)));
        assert_eq!(chooses(false, "--method auto"), open(1e-7));
        assert_eq!(chooses(false, "--method auto --tol 1e-5"), open(1e-5));
        assert_eq!(chooses(true, ""), open(1e-7));
        assert_eq!(chooses(true, "--tol 1e-4"), open(1e-4));
        let named = Some((false, Method::controlled(Scheme::Radau5, 1e-7)));
        assert_eq!(chooses(true, "--method radau5"), named);
        assert_eq!(chooses(true, "--dt 0.1"), Some((false, Method::rk4(0.1))));
        // A tolerance alone keeps the method that a scene names.
        assert_eq!(
            chooses(false, "--tol 1e-4"),
            Some((false, Method::dormand_prince(1e-4)))
        );
    }

    #[test]
    fn sampling_is_that_of_the_scene_unless_named() {
        let sampling = |options: &str| {
            let settings = settings(Method::rk4(0.5), options);
            settings.map(|settings| settings.sampling)
        };
        assert_eq!(sampling(""), Some(Sampling::Landing));
        assert_eq!(sampling("--sampling dense --at 1"), Some(Sampling::Dense));
        assert_eq!(sampling("--sampling thin"), None);
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let scene = Method::rk4(0.5);
        for options in [
            "--method rk4 --tol 1e-6",
            "--method gauss2 --tol 1e-6",
            "--method auto --dt 0.1",
            "--dt 0.1 --tol 1e-6",
            "--dt 0",
            "--dt -1",
            "--tol nan",
            "--tol 0.5",
            "--tol 1e-20",
            "--t-end -1",
            "--t-end inf",
            "--sample-step 0",
            "--at 1,2 --sample-step 0.1",
            "--json --quiet",
        ] {
            assert_eq!(settings(scene, options), None, "{options}");
        }
    }
}
