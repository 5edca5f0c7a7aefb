//! From space to the page: a parallel projection, z up, x to the lower left, y to the right.

/// Where a point lies on the page, in pixels.
pub type Spot = (f64, f64);

/// Azimuth of the viewer about z, rad: odd numbers, so that no drawn coordinate is half a rounding unit by symmetry.
const AZIMUTH: f64 = 0.5713;
/// Elevation of the viewer above the plane z = 0, rad.
const ELEVATION: f64 = 0.4337;
/// Free space around what is drawn, in pixels.
const MARGIN: f64 = 17.0;
/// Pixels of a metre at most, so that small motions are not drawn larger than frames can be.
const LARGEST_SCALE: f64 = 110.0;

/// A scale and a position of the projection.
#[derive(Clone, Copy, Debug)]
pub struct View {
    scale: f64,
    offset: Spot,
}

impl View {
    /// The view that shows all points in a picture of the given size.
    pub fn fitting(points: impl Iterator<Item = [f64; 3]>, width: f64, height: f64) -> Self {
        let (mut low, mut high) = ((f64::MAX, f64::MAX), (f64::MIN, f64::MIN));
        for (x, y) in points.map(projected) {
            low = (low.0.min(x), low.1.min(y));
            high = (high.0.max(x), high.1.max(y));
        }
        let fit = |room: f64, size: f64| (room - 2.0 * MARGIN) / size.max(1e-9);
        let scale = fit(width, high.0 - low.0)
            .min(fit(height, high.1 - low.1))
            .min(LARGEST_SCALE);
        let centred = |room: f64, low: f64, high: f64| 0.5 * (room - scale * (low + high));
        let offset = (
            centred(width, low.0, high.0),
            centred(height, low.1, high.1),
        );
        Self { scale, offset }
    }

    /// Where a point lies.
    pub fn spot(&self, point: [f64; 3]) -> Spot {
        let (x, y) = projected(point);
        (
            self.scale * x + self.offset.0,
            self.scale * y + self.offset.1,
        )
    }
}

/// On the page at scale 1, downwards.
fn projected([x, y, z]: [f64; 3]) -> Spot {
    let ((sin, cos), (rise, level)) = (AZIMUTH.sin_cos(), ELEVATION.sin_cos());
    (cos * y - sin * x, rise * (cos * x + sin * y) - level * z)
}

/// Whether a surface with this normal faces the viewer.
pub fn faces_viewer([x, y, z]: [f64; 3]) -> bool {
    let ((sin, cos), (rise, level)) = (AZIMUTH.sin_cos(), ELEVATION.sin_cos());
    level * (cos * x + sin * y) + rise * z > 0.0
}
