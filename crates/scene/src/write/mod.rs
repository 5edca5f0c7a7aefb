//! A scene as the text of a scene file, made to be read by people; it reads back as the same scene.

mod body;
mod controller;
mod forces;
mod pose;
mod shape;
mod ties;
mod time;
mod value;

use crate::arithmetic::Arithmetic;
use crate::description::SceneDescription;
use crate::settings::Settings;
use crate::text::visible_line;
use hamel_integrate::{Method, Sampling};
use value::{list, number, text};

impl SceneDescription {
    /// The text of a scene file that says the same. `head` comes first, and `beside` gives what is to be said of each joint by
    /// name; both as comments.
    ///
    /// Numbers read back as they are; rotations to a few 1e-16, as they are written in the way that suits them best.
    pub fn to_toml(&self, head: &[String], beside: impl Fn(&str) -> Vec<String>) -> String {
        let mut out = String::new();
        comments(&mut out, head);
        out.push_str("hamel = 1\n");
        out.push_str(&format!("name = {}\n", text(&self.name)));
        if !self.description.is_empty() {
            out.push_str(&format!("description = {}\n", text(&self.description)));
        }
        out.push_str(&format!("gravity = {}\n", list(&self.gravity)));
        for group in self.bodies.chunk_by(|_, next| !next.leads()) {
            let Some(first) = group.first() else { continue };
            out.push('\n');
            comments(&mut out, &beside(&first.joint.name.value));
            body::bodies(&mut out, first, group, &self.bodies);
        }
        ties::ties(&mut out, self);
        forces::elements(&mut out, self);
        shape::shapes(&mut out, self);
        if let Some(found) = &self.controller {
            controller::controller(&mut out, found);
        }
        settings(&mut out, &self.settings);
        out
    }
}

fn comments(out: &mut String, lines: &[String]) {
    for line in lines.iter().flat_map(|lines| lines.lines()) {
        out.push_str(&format!("# {}\n", visible_line(line)));
    }
}

fn settings(out: &mut String, settings: &Settings) {
    let accuracy = match (settings.accuracy, settings.method) {
        (Some(accuracy), _) => format!("accuracy = {}", number(accuracy)),
        (None, Method::Fixed { dt, .. }) => format!("dt = {}", number(dt)),
        (None, Method::Controlled { control, .. }) => {
            format!("tol = {}", number(control.tolerance))
        }
    };
    let (t_end, step) = (number(settings.t_end), number(settings.sample_step));
    let (form, method) = (text(settings.form_name()), text(settings.method_name()));
    out.push_str(&format!(
        "\n[simulation]\nt_end = {t_end}\nmethod = {method}\n{accuracy}\nform = {form}\nsample_step = {step}\n"
    ));
    if settings.arithmetic != Arithmetic::default() {
        entry(out, "arithmetic", &text(settings.arithmetic.name()));
    }
    if settings.sampling != Sampling::default() {
        entry(out, "sampling", &text(settings.sampling_name()));
    }
}

/// Appends `key = value`.
fn entry(out: &mut String, key: &str, value: &str) {
    out.push_str(&format!("{key} = {value}\n"));
}
