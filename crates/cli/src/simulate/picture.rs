//! Pictures of a run, as the files that `--picture`, `--png` and `--gif` name.

use super::plan::Plan;
use super::progress;
use hamel::mechanism::Kinematics;
use hamel_console::files::{Draft, Output, first_line};
use hamel_console::output::{Failure, tell};
use hamel_pictures::Playing;
use hamel_scene::{Notice, Severity};
use std::fs::File;
use std::io::{self, Write};

/// Whether a file is a picture as SVG that was written before.
pub fn is_own(file: &File) -> bool {
    hamel_pictures::is_svg(&first_line(file))
}

/// Whether a file is a picture as PNG that was written before.
pub fn is_own_png(file: &File) -> bool {
    hamel_pictures::is_png(file)
}

/// Whether a file is a motion as GIF that was written before.
pub fn is_own_gif(file: &File) -> bool {
    hamel_pictures::is_gif(file)
}

/// Where pictures of a motion go, as far as they are asked for.
#[derive(Debug)]
pub struct Outputs {
    pub svg: Option<Output>,
    pub png: Option<Output>,
    pub gif: Option<Output>,
    /// How many instants a still picture shows.
    pub instants: usize,
}

impl Outputs {
    /// Those that are asked for.
    pub fn files(&self) -> impl Iterator<Item = &Output> {
        [&self.svg, &self.png, &self.gif].into_iter().flatten()
    }

    /// Whether one of them shows meshes.
    pub const fn has_meshes(&self) -> bool {
        self.png.is_some() || self.gif.is_some()
    }
}

/// Pictures being recorded.
pub struct Pictures<'a> {
    plan: &'a Plan,
    svg: Option<Draft>,
    png: Option<Draft>,
    gif: Option<Draft>,
    pictures: hamel_pictures::Pictures,
}

impl<'a> Pictures<'a> {
    /// Begins the files that `plan` asks for, if it asks for one.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn create(plan: &'a Plan) -> Result<Option<Self>, Failure> {
        let outputs = &plan.pictures;
        if outputs.files().next().is_none() {
            return Ok(None);
        }
        let open = |output: &Option<Output>| output.as_ref().map(Output::open).transpose();
        Ok(Some(Self {
            plan,
            svg: open(&outputs.svg)?,
            png: open(&outputs.png)?,
            gif: open(&outputs.gif)?,
            pictures: hamel_pictures::Pictures::default(),
        }))
    }

    /// Takes a sample.
    pub fn sample(&mut self, time: f64, kinematics: &Kinematics) {
        self.pictures.sample(time, kinematics);
    }

    /// Draws the pictures, and gives the files their names.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(self) -> Result<(), Failure> {
        let (plan, pictures) = (self.plan, &self.pictures);
        let (scene, meshes, outputs) = (&plan.scene, &plan.meshes, &plan.pictures);
        let instants = outputs.instants;
        let svg = finished(self.svg, &outputs.svg, |file| {
            file.write_all(pictures.svg(scene, instants).as_bytes())
        });
        let png = finished(self.png, &outputs.png, |file| {
            pictures.write_png(scene, meshes, instants, file)
        });
        let gif = finished(self.gif, &outputs.gif, |file| {
            if !plan.quiet {
                tell(note(pictures.playing()).as_slice());
            }
            let bar = progress::working("choosing the colours of the GIF", plan.quiet);
            let written = pictures.write_gif(scene, meshes, file, &mut |drawn, count| {
                if drawn > 0 {
                    bar.set_message(format!("drawing the GIF: {drawn} of {count} pictures"));
                }
                Ok(())
            });
            bar.finish_and_clear();
            written
        });
        svg.and(png).and(gif)
    }
}

/// Writes a file that was asked for, and gives it its name.
fn finished(
    draft: Option<Draft>,
    output: &Option<Output>,
    write: impl FnOnce(&mut Draft) -> io::Result<()>,
) -> Result<(), Failure> {
    let (Some(mut file), Some(output)) = (draft, output) else {
        return Ok(());
    };
    write(&mut file).map_err(|error| Failure::write(output.path(), error))?;
    file.finish()
}

/// What to tell of how a motion plays, if it plays at another speed than its own.
fn note(playing: Playing) -> Option<Notice> {
    (playing.speed != 1.0).then(|| Notice {
        severity: Severity::Note,
        message: format!(
            "the GIF plays at {:.3} times the speed of the motion",
            playing.speed
        ),
        elements: vec![],
    })
}
