//! What a user writes: a joint of one's own, and a compiled scene with a batch.

mod compiled_scene;
mod own_joint;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    own_joint::main()?;
    compiled_scene::main()
}
