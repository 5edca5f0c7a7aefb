use hamel_scene::urdf::{Options, read};
#[test]
fn tmp() {
    for name in ["panda7", "anymal", "g1", "pendulum"] {
        let path = format!(
            "{}/../../tests/data/urdf/{name}.urdf",
            env!("CARGO_MANIFEST_DIR")
        );
        let text = std::fs::read_to_string(&path).unwrap();
        match read(
            &text,
            name,
            &Options {
                floating_base: name == "g1" || name == "anymal",
                ..Options::default()
            },
        ) {
            Ok(i) => {
                println!(
                    "{name} {} bodies {} frames, mass {}",
                    i.scene.bodies.len(),
                    i.scene.frames.len(),
                    i.scene.bodies.iter().map(|b| b.mass.mass).sum::<f64>()
                );
                for n in i.notices {
                    println!("   {n}")
                }
            }
            Err(e) => println!("{e}"),
        }
    }
}
