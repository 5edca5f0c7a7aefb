//! A motion as GIF: each picture holds what differs from the one before, in 255 colours that all have in common.

use super::super::Instant;
use super::super::scenery::Scenery;
use super::layer::Rgb;
use super::{MARK, Painter, has_mark};
use color_quant::NeuQuant;
use fnv::FnvHashMap;
use gif::{AnyExtension, DisposalMethod, Encoder, EncodingError, Extension, Frame, Repeat};
use std::io::{self, Read, Write};

/// Width and height, pixels.
const SIZE: (u16, u16) = (640, 426);

/// Shortest and longest time that a motion plays, s.
const SHORTEST: f64 = 2.0;
const LONGEST: f64 = 20.0;

/// Pictures a second at most.
const RATE: f64 = 25.0;

/// Pictures of which colours are chosen at most, and of how many of their pixels one is looked at.
const MOST_LOOKED_AT: usize = 16;
const ONE_OF: usize = 31;

/// Hundredths of a second that programs show each picture at least: shorter ones are taken for no time at all.
const LEAST: f64 = 2.0;

/// The index of no colour: what the picture before shows stays.
const SAME: u8 = 255;

/// Whether a file is a moving picture that was written here.
pub fn is_gif(file: impl Read) -> bool {
    has_mark(file, b"GIF89a")
}

/// How a motion plays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Playing {
    /// Pictures.
    pub count: usize,
    /// How many times as fast as the motion.
    pub speed: f64,
}

impl Playing {
    /// A motion of `duration` s with so many samples: as fast as it is, unless it is shorter or longer than pictures play.
    pub fn of(duration: f64, samples: usize) -> Self {
        let played = duration.clamp(SHORTEST, LONGEST);
        let count = (played * RATE).round() as usize + 1;
        match duration > 0.0 {
            true => Self {
                count: count.min(samples),
                speed: duration / played,
            },
            false => Self {
                count: 1,
                speed: 1.0,
            },
        }
    }
}

/// Writes the motion through `instants`, again and again. `told` hears how many pictures are drawn, 0 while colours are chosen, and may end the work by an error.
///
/// # Errors
/// What cannot be written; an error of `told`.
pub fn write(
    scenery: &Scenery,
    instants: &[Instant],
    playing: Playing,
    file: &mut impl Write,
    told: &mut dyn FnMut(usize) -> io::Result<()>,
) -> io::Result<()> {
    let painter = Painter::new(scenery, instants, SIZE);
    let mut colors = Colors::of(&painter, instants, told)?;
    let palette = colors.palette();
    let mut encoder = Encoder::new(file, SIZE.0, SIZE.1, &palette).map_err(written)?;
    encoder
        .write_raw_extension(AnyExtension(Extension::Comment as u8), &[MARK.as_bytes()])
        .map_err(written)?;
    encoder.set_repeat(Repeat::Infinite).map_err(written)?;
    let mut before: Option<Vec<u8>> = None;
    for (index, instant) in instants.iter().enumerate() {
        let pixels = painter.picture(std::slice::from_ref(instant));
        let indices: Vec<u8> = pixels.iter().map(|color| colors.index(*color)).collect();
        let mut frame = match &before {
            None => whole(&indices),
            Some(before) => difference(before, &indices),
        };
        frame.delay = delay(instants, index, playing.speed);
        encoder.write_frame(&frame).map_err(written)?;
        before = Some(indices);
        told(index + 1)?;
    }
    Ok(())
}

/// How long an instant is shown, hundredths of a second, of which rounding loses none over the whole motion; the last one for a second.
fn delay(instants: &[Instant], index: usize, speed: f64) -> u16 {
    let Some(next) = instants.get(index + 1) else {
        return 100;
    };
    let hundredths = |time: f64| (100.0 * (time - instants[0].time) / speed).round();
    (hundredths(next.time) - hundredths(instants[index].time)).max(LEAST) as u16
}

/// The colours of all pictures.
struct Colors {
    chosen: NeuQuant,
    known: FnvHashMap<Rgb, u8>,
}

impl Colors {
    /// Those that serve some of the instants best.
    ///
    /// # Errors
    /// Those of `told`.
    fn of(
        painter: &Painter<'_>,
        instants: &[Instant],
        told: &mut dyn FnMut(usize) -> io::Result<()>,
    ) -> io::Result<Self> {
        let step = instants.len().div_ceil(MOST_LOOKED_AT).max(1);
        let mut looked_at = vec![];
        for instant in instants.iter().step_by(step) {
            told(0)?;
            let pixels = painter.picture(std::slice::from_ref(instant));
            let some = pixels.into_iter().step_by(ONE_OF);
            looked_at.extend(some.flat_map(|[red, green, blue]| [red, green, blue, 255]));
        }
        Ok(Self {
            chosen: NeuQuant::new(1, usize::from(SAME), &looked_at),
            known: FnvHashMap::default(),
        })
    }

    fn palette(&self) -> Vec<u8> {
        let mut palette = self.chosen.color_map_rgb();
        palette.resize(3 * 256, 0);
        palette
    }

    /// The nearest of them.
    fn index(&mut self, color: Rgb) -> u8 {
        let [red, green, blue] = color;
        let nearest = || self.chosen.index_of(&[red, green, blue, 255]) as u8;
        *self.known.entry(color).or_insert_with(nearest)
    }
}

fn whole(indices: &[u8]) -> Frame<'_> {
    Frame {
        width: SIZE.0,
        height: SIZE.1,
        dispose: DisposalMethod::Keep,
        buffer: indices.into(),
        ..Frame::default()
    }
}

/// The smallest rectangle in which two pictures differ.
fn difference(before: &[u8], after: &[u8]) -> Frame<'static> {
    let wide = usize::from(SIZE.0);
    let differs = |place: &usize| before[*place] != after[*place];
    let places = || (0..after.len()).filter(differs);
    let rows = bounds(places().map(|place| place / wide));
    let columns = bounds(places().map(|place| place % wide));
    let pixels = rows.clone().flat_map(|row| {
        let columns = columns.clone();
        columns.map(move |column| row * wide + column)
    });
    let buffer: Vec<u8> = pixels
        .map(|place| if differs(&place) { after[place] } else { SAME })
        .collect();
    Frame {
        left: columns.start as u16,
        top: rows.start as u16,
        width: columns.len() as u16,
        height: rows.len() as u16,
        transparent: Some(SAME),
        dispose: DisposalMethod::Keep,
        buffer: buffer.into(),
        ..Frame::default()
    }
}

/// From the least to the greatest; one pixel where there is none.
fn bounds(places: impl Iterator<Item = usize>) -> std::ops::Range<usize> {
    let ends = places.fold(None, |ends: Option<(usize, usize)>, place| match ends {
        None => Some((place, place)),
        Some((least, greatest)) => Some((least.min(place), greatest.max(place))),
    });
    ends.map_or(0..1, |(least, greatest)| least..greatest + 1)
}

fn written(error: EncodingError) -> io::Error {
    match error {
        EncodingError::Io(error) => error,
        other => io::Error::other(other),
    }
}

#[cfg(test)]
mod tests {
    use super::{Instant, Playing, SAME, SIZE, delay, difference};

    #[test]
    fn a_motion_plays_as_fast_as_it_is_unless_that_is_too_short_or_too_long() {
        let playing = |count, speed| Playing { count, speed };
        assert_eq!(Playing::of(4.0, 512), playing(101, 1.0));
        assert_eq!(Playing::of(4.0, 30), playing(30, 1.0));
        assert_eq!(Playing::of(100.0, 512), playing(501, 5.0));
        assert_eq!(Playing::of(0.02, 512), playing(51, 0.01));
        assert_eq!(Playing::of(0.0, 1), playing(1, 1.0));
    }

    #[test]
    fn times_between_pictures_sum_to_the_time_of_the_motion() {
        let instants: Vec<Instant> = (0..=30)
            .map(|index| Instant {
                time: f64::from(index) / 30.0,
                poses: vec![],
            })
            .collect();
        let delays = (0..30).map(|index| delay(&instants, index, 0.5));
        assert_eq!(delays.sum::<u16>(), 200);
    }

    #[test]
    fn a_picture_holds_what_differs_from_the_one_before() {
        let (wide, high) = (usize::from(SIZE.0), usize::from(SIZE.1));
        let before = vec![3; wide * high];
        let mut after = before.clone();
        for (row, column) in [(5, 7), (6, 9)] {
            after[row * wide + column] = 4;
        }
        let frame = difference(&before, &after);
        assert_eq!((frame.left, frame.top), (7, 5));
        assert_eq!((frame.width, frame.height), (3, 2));
        assert_eq!(*frame.buffer, [4, SAME, SAME, SAME, SAME, 4]);
        // Nothing that differs is one pixel that stays.
        let same = difference(&after, &after);
        assert_eq!(
            (same.width, same.height, &*same.buffer),
            (1, 1, &[SAME][..])
        );
    }
}
