//! Joint types of the library, derived when a scene names them.

use hamel_compiler::JointType;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

/// The joint types that scenes have named so far; each thread has its own.
#[derive(Debug, Default)]
pub struct Joints {
    known: RefCell<BTreeMap<String, Option<Rc<JointType>>>>,
}

impl Joints {
    /// The type of a name; `None` where the library has none that the scene compiler takes.
    pub fn find(&self, name: &str) -> Option<Rc<JointType>> {
        let known = self.known.borrow().get(name).cloned();
        known.unwrap_or_else(|| {
            let derived = derived(name);
            let mut known = self.known.borrow_mut();
            known.entry(name.to_owned()).or_insert(derived).clone()
        })
    }
}

fn derived(name: &str) -> Option<Rc<JointType>> {
    let text = hamel_joints::spec(name)?;
    let derived = hamel_codegen::derive(text, &format!("{name}.joint")).ok()?;
    JointType::new(derived).ok().map(Rc::new)
}
