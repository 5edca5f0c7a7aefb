//! The numbers of a page as bytes: little-endian, times as f64, everything else as f32.

use crate::sample::seven;
use hamel::spatial::Pose;

/// Times, columns and poses of the frames so far.
#[derive(Debug)]
pub struct Blob {
    times: Vec<f64>,
    columns: Vec<Vec<f32>>,
    poses: Vec<f32>,
}

impl Blob {
    /// No frame yet, of so many columns.
    pub fn new(columns: usize) -> Self {
        Self {
            times: Vec::new(),
            columns: vec![Vec::new(); columns],
            poses: Vec::new(),
        }
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.times.len()
    }

    /// Adds a frame.
    pub fn push(&mut self, time: f64, values: &[f64], poses: impl Iterator<Item = Pose<f64>>) {
        self.times.push(time);
        for (column, &value) in self.columns.iter_mut().zip(values) {
            column.push(value as f32);
        }
        self.poses.extend(
            poses
                .flat_map(|pose| seven(&pose))
                .map(|number| number as f32),
        );
    }

    /// Adds a column, with one number for each frame.
    pub fn add_column(&mut self, values: impl Iterator<Item = f64>) {
        self.columns
            .push(values.map(|value| value as f32).collect());
    }

    /// All times; then each column; then, frame by frame, the seven numbers of every body.
    pub fn bytes(&self) -> Vec<u8> {
        let times = self.times.iter().flat_map(|time| time.to_le_bytes());
        let rest = self.columns.iter().flatten().chain(&self.poses);
        times
            .chain(rest.flat_map(|number| number.to_le_bytes()))
            .collect()
    }
}
