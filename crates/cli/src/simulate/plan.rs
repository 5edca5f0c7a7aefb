//! What one run of `hamel simulate` is to do: the scene, the settings, the times and the files.

use super::args::Args;
use super::request::Request;
use super::{csv, metadata, page, parquet, picture, settings, times};
use crate::input::Input;
use hamel::integrate::{Method, Options, Sampling};
use hamel::registry::JointRegistry;
use hamel::shown::Number;
use hamel_console::files::{Output, admit, is_stdout};
use hamel_console::output::{Failure, tell};
use hamel_pictures::Meshes;
use hamel_scene::{Arithmetic, Company, Control, SampleError, Scene, Settings};
use std::path::{Path, PathBuf};

/// A run, decided in every respect.
#[derive(Debug)]
pub struct Plan {
    /// What was read, of which the scene is made.
    pub input: Input,
    /// The scene as loaded.
    pub scene: Scene,
    /// Its settings under the options given; `t_end` is the end of the simulation.
    pub settings: Settings,
    /// Why the method was chosen, where the choice was left open.
    pub reason: Option<String>,
    /// Whether the choice of the method is looked at again on the way; compiled equations have what one method needs.
    pub is_open: bool,
    /// What was settled of the arithmetic, and why, where it was left open.
    pub arithmetic_reason: Option<String>,
    /// What came of the accuracy that was asked for, if one was.
    pub request: Option<Request>,
    /// What controls the mechanism, if anything does.
    pub control: Option<Control>,
    /// Sample times, s.
    pub times: Vec<f64>,
    /// Where the trajectory goes as CSV, if anywhere.
    pub csv: Option<Output>,
    /// Where the metadata of the CSV file go, if there is one.
    pub metadata: Option<Output>,
    /// Where it goes as Parquet, if anywhere.
    pub parquet: Option<Output>,
    /// Where it goes as a page to look at, if anywhere.
    pub html: Option<Output>,
    /// The meshes that the page and pictures of pixels show.
    pub meshes: Meshes,
    /// Whether the forces within joints are reported.
    pub forces: bool,
    /// Whether it is printed as JSON.
    pub json: bool,
    /// Where pictures of it go.
    pub pictures: picture::Outputs,
    /// Whether nothing but failures is reported.
    pub quiet: bool,
}

impl Plan {
    /// Loads the scene of `args` and lays the options over its settings.
    ///
    /// # Errors
    /// Mistakes in the scene; options out of range; a first state to which no method can be chosen; files that must not be written.
    pub fn new(args: &Args, registry: &JointRegistry) -> Result<Self, Failure> {
        let input = Input::read(&args.scene, &args.robot)?;
        let scene = input.scene(registry)?;
        let control = match &args.controller {
            Some(path) => Some(Control::load(path, &scene)?),
            None => scene.control.clone(),
        };
        if !args.quiet {
            tell(&scene.notices);
        }
        let mut settings = settings::overridden(&scene.settings, args)?;
        if args.compiled && settings.arithmetic == Arithmetic::Auto {
            // Compiled equations have no other.
            settings.arithmetic = Arithmetic::Doubles;
        }
        let times = if args.at.is_empty() {
            settings.sample_times(0.0).map_err(refused)?
        } else {
            let given = args.t_end.map(|_| settings.t_end);
            let (times, t_end) = times::chosen(&args.at, given)?;
            settings.t_end = t_end;
            times
        };
        scene.check_start(&settings, control.as_ref())?;
        let [csv, metadata, parquet, html, svg, png, gif] = outputs(args)?;
        let pictures = picture::Outputs {
            svg,
            png,
            gif,
            instants: args.instants.into(),
        };
        let meshes = match html.is_some() || pictures.has_meshes() {
            true => Meshes::load(&scene.shapes, input.folder()),
            false => Meshes::default(),
        };
        if !args.quiet {
            tell(meshes.notices());
        }
        let mut plan = Self {
            input,
            scene,
            settings,
            reason: None,
            arithmetic_reason: None,
            request: None,
            is_open: settings.chooses && !args.compiled,
            control,
            times,
            csv,
            metadata,
            parquet,
            html,
            meshes,
            forces: args.forces,
            json: args.json,
            pictures,
            quiet: args.quiet,
        };
        // For an accuracy, the tolerance is searched for first.
        if settings.accuracy.is_none() {
            plan.choose(tolerance(&settings))?;
        }
        Ok(plan)
    }

    /// Settles the method with this tolerance, and why it is that one, where the choice is left open.
    ///
    /// # Errors
    /// A first state to which no method can be chosen.
    pub fn choose(&mut self, tolerance: f64) -> Result<(), Failure> {
        let settings = self.settings.with_tolerance(tolerance);
        let company = Company {
            has_inputs: self.control.is_some(),
            has_events: false,
        };
        let chosen = self
            .scene
            .choose_method(&settings, &self.scene.start(), company);
        let chosen = chosen.map_err(|error| Failure::Simulation(error.to_string()))?;
        (self.settings.method, self.reason) = chosen;
        Ok(())
    }

    /// Settles the arithmetic, where it is left open: refined for a reason, doubles without one.
    pub fn settle_arithmetic(&mut self, reason: Option<String>) {
        if self.settings.arithmetic != Arithmetic::Auto {
            return;
        }
        (self.settings.arithmetic, self.arithmetic_reason) = match reason {
            Some(_) => (Arithmetic::Refined, reason),
            None => (
                Arithmetic::Doubles,
                Some("their rounding does not decide the accuracy".into()),
            ),
        };
    }

    /// Whether anything but gravity can change the energy.
    pub fn does_work(&self) -> bool {
        self.control.is_some() || hamel_pictures::does_work(&self.scene.mechanism)
    }

    /// The files of the trajectory.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.outputs().map(Output::path)
    }

    /// Whether one of them is stdout, where nothing else can be reported then.
    pub fn writes_stdout(&self) -> bool {
        self.outputs().any(Output::is_stdout)
    }

    /// The files that have all samples.
    pub fn trajectories(&self) -> impl Iterator<Item = &Path> {
        self.of_all_samples().map(Output::path)
    }

    fn of_all_samples(&self) -> impl Iterator<Item = &Output> {
        [&self.csv, &self.parquet, &self.html].into_iter().flatten()
    }

    fn outputs(&self) -> impl Iterator<Item = &Output> {
        self.of_all_samples().chain(self.pictures.files())
    }

    /// Whether anything asks for the numbers of all columns.
    pub fn has_rows(&self) -> bool {
        self.json || self.csv.is_some() || self.parquet.is_some()
    }

    /// Whether the trajectory goes to any file.
    pub fn has_files(&self) -> bool {
        self.files().next().is_some()
    }

    /// The method of integration and its accuracy, in words.
    pub fn method(&self) -> String {
        let name = self.settings.method.scheme().name();
        match self.settings.method {
            Method::Fixed { dt, .. } => {
                let shorter = self.times.windows(2).any(|pair| pair[1] - pair[0] < dt);
                let lands = self.settings.sampling == Sampling::Landing;
                let note = if shorter && lands {
                    ", shorter where samples are closer"
                } else {
                    ""
                };
                format!("{name} with steps of {:?} s{note}", Number(dt))
            }
            Method::Controlled { control, .. } => format!("{name} to {:e}", control.tolerance),
        }
    }

    /// What the integrator is asked to do.
    pub fn options(&self) -> Options {
        Options {
            form: self.settings.form,
            method: self.settings.method,
            t_end: self.settings.t_end,
            samples: self.times.clone(),
        }
    }
}

/// The tolerance of settings, 0 where steps have one length.
fn tolerance(settings: &Settings) -> f64 {
    let control = settings.method.control();
    control.map_or(0.0, |control| control.tolerance)
}

/// Samples that cannot be taken, and what to do.
fn refused(error: SampleError) -> Failure {
    Failure::Options(format!("{error}: choose a larger --sample-step"))
}

/// The files of the trajectory: as CSV with its metadata, as Parquet, as a page and as pictures.
fn outputs(args: &Args) -> Result<[Option<Output>; 7], Failure> {
    let csv = csv_path(args);
    let metadata = csv.as_deref().and_then(metadata::path);
    let paths = [
        &csv,
        &metadata,
        &args.parquet,
        &args.html,
        &args.picture,
        &args.png,
        &args.gif,
    ];
    let paths = paths.map(Option::as_deref);
    if args.json && paths.into_iter().flatten().any(is_stdout) {
        let both =
            "`--json` prints on stdout, and so would `-`: name a file, `./-` for one of that name";
        return Err(Failure::Options(both.into()));
    }
    let known = [
        csv::is_own,
        metadata::is_own,
        parquet::is_own,
        page::is_own,
        picture::is_own,
        picture::is_own_png,
        picture::is_own_gif,
    ];
    let written = paths.into_iter().zip(known);
    let written = written.filter_map(|(path, is_own)| Some((path?, is_own as _)));
    let read = [Some(&args.scene), args.controller.as_ref()];
    let read = read.into_iter().flatten().map(PathBuf::as_path);
    let mut admitted = admit(read, written, args.force.force)?.into_iter();
    // Those that are asked for, in their order.
    Ok(paths.map(|path| path.and_then(|_| admitted.next())))
}

/// The file asked for; else, unless something else is wanted, the scene's file name with `.csv` in the current folder.
fn csv_path(args: &Args) -> Option<PathBuf> {
    let default = || {
        let stem = args.scene.file_stem().unwrap_or("trajectory".as_ref());
        let mut name = Path::new(stem).as_os_str().to_owned();
        name.push(".csv");
        PathBuf::from(name)
    };
    match &args.csv {
        Some(path) => Some(path.clone()),
        None => {
            let others = [
                &args.parquet,
                &args.html,
                &args.picture,
                &args.png,
                &args.gif,
            ];
            let is_alone = others.into_iter().all(Option::is_none);
            (!args.json && is_alone).then(default)
        }
    }
}
