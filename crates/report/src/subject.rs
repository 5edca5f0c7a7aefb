//! What is measured: a scene in one representation, with its equations of motion in one implementation.

use super::measure::Failed;
use super::plan::Plan;
use super::representation::Representation;
use super::row;
use super::store::Store;
use hamel::dynamics::Dynamics;
use hamel::registry::JointRegistry;
use hamel_compiler::functions::Kind;
use hamel_console::compiled::compiled;
use hamel_console::output::Failure;
use hamel_native::{Compiler, Equations};
use hamel_scene::{Diagnostics, Scene, SceneDescription};
use itertools::Itertools;

/// How the equations of motion are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Implementation {
    /// By recursions over the tree, in the arithmetic that the scene asks for.
    Tree,
    /// By code that the scene compiler has written for the scene, in doubles.
    Compiled,
}

impl Implementation {
    /// As files write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tree => "tree",
            Self::Compiled => "compiled",
        }
    }
}

/// A scene that was built, and its equations.
pub struct Subject {
    scene: Result<Scene, Diagnostics>,
    equations: Option<Result<Either, Failure>>,
    description: SceneDescription,
    name: &'static str,
    /// Its representation and its implementation.
    pub kind: (Representation, Implementation),
}

/// Equations of motion.
enum Either {
    Tree(Box<dyn Dynamics>),
    Compiled(Box<Equations>),
}

impl Subject {
    /// The scene `name` in a representation; its equations are made when they are wanted.
    pub fn new(
        name: &'static str,
        description: &SceneDescription,
        kind: (Representation, Implementation),
        registry: &JointRegistry,
    ) -> Self {
        let description = kind.0.apply(description);
        Self {
            scene: description.build(registry),
            equations: None,
            description,
            name,
            kind,
        }
    }

    /// The scene and its equations, for the forms of a plan in this representation. What compilation cost is added to `store` where that has not been measured.
    ///
    /// # Errors
    /// A scene that cannot be built or compiled, which is a failure of its runs.
    pub fn parts(
        &mut self,
        plan: &Plan,
        machine: &str,
        store: &mut Store<row::Build>,
    ) -> Result<Result<(&Scene, &mut dyn Dynamics), Failed>, Failure> {
        let scene = match &self.scene {
            Ok(scene) => scene,
            Err(errors) => return Ok(Err(Failed::at_once(&errors.to_string()))),
        };
        if self.equations.is_none() {
            let made = match (self.kind.1, &plan.compiler) {
                (Implementation::Compiled, Some(compiler)) => {
                    let made = self.compiled(plan, scene, compiler);
                    if let Ok(equations) = &made {
                        let row = self.build_row(equations, machine);
                        if store.find(&row::Row::key(&row)).is_none() {
                            store.add(&[row])?;
                        }
                    }
                    made.map(|equations| Either::Compiled(Box::new(equations)))
                }
                _ => {
                    let tree = scene.settings.arithmetic.dynamics(&scene.mechanism);
                    Ok(Either::Tree(tree))
                }
            };
            self.equations = Some(made);
        }
        Ok(match &mut self.equations {
            Some(Ok(Either::Tree(tree))) => Ok((scene, &mut **tree)),
            Some(Ok(Either::Compiled(equations))) => Ok((scene, &mut equations.dynamics)),
            Some(Err(failure)) => Err(Failed::at_once(&failure.to_string())),
            None => Err(Failed::at_once("there are no equations")),
        })
    }

    fn compiled(
        &self,
        plan: &Plan,
        scene: &Scene,
        compiler: &Compiler,
    ) -> Result<Equations, Failure> {
        let called = plan.schemes.iter().flat_map(|&scheme| {
            let forms = plan.forms_of(scheme, self.kind.0, self.kind.1);
            forms.iter().map(move |&form| (form, scheme))
        });
        let kinds: Vec<Kind> = called
            .flat_map(|(form, scheme)| hamel_native::functions(form, scheme))
            .copied()
            .unique_by(|kind| kind.name())
            .collect();
        let build = hamel_compiler::scene_of(self.name, self.description.clone());
        let build = build.library(hamel_joints::specs());
        compiled(build, self.name, &kinds, compiler, scene)
    }

    fn build_row(&self, equations: &Equations, machine: &str) -> row::Build {
        let names = equations.functions.iter().map(|kind| kind.name());
        row::Build {
            scene: self.name.into(),
            representation: self.kind.0.name().into(),
            functions: names.collect::<Vec<_>>().join(" "),
            generation_s: equations.cost.generation,
            compilation_s: equations.cost.compilation,
            text_bytes: equations.cost.text,
            library_bytes: equations.cost.library,
            compiler: equations.compiler.clone(),
            machine: machine.into(),
        }
    }
}
