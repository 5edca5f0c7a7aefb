use hamel_tests::accuracy::measure;
#[test]
fn ellipsoid() {
    let derived = hamel_tests::derived("ellipsoid");
    let joint = hamel_joints::Ellipsoid { a: 1.0, b: 0.6, c: 0.4 };
    let n = std::env::var("N").map_or(2000, |n| n.parse().unwrap());
    let worst = measure::<f64, _, 9, 3, 3, 0>(&joint, &derived, n, &|_| {});
    for (k, (e, place)) in &worst.errors { println!("{k} {e:.2} {}", if *e > 8.0 { place } else { "" }); }
}
#[test]
fn falling_disk() {
    let derived = hamel_tests::derived("falling_disk");
    let joint = hamel_joints::FallingDisk { radius: 0.3 };
    let n = std::env::var("N").map_or(2000, |n| n.parse().unwrap());
    let worst = measure::<f64, _, 11, 5, 3, 2>(&joint, &derived, n, &|_| {});
    for (k, (e, place)) in &worst.errors { println!("{k} {e:.2} {}", if *e > 8.0 { place } else { "" }); }
}
