//! Frames as GIF.

use super::palette::TRANSPARENT;
use super::{Animation, Frame};
use crate::raster::DrawError;
use gif::{DisposalMethod, Encoder, EncodingError, Repeat};
use std::borrow::Cow;

pub(super) fn encode(animation: &Animation) -> Result<Vec<u8>, DrawError> {
    if animation.frames.is_empty() {
        return Err(DrawError::Gif("there is no frame".to_owned()));
    }
    write(animation).map_err(|error| DrawError::Gif(error.to_string()))
}

fn write(animation: &Animation) -> Result<Vec<u8>, EncodingError> {
    let mut bytes = Vec::new();
    let palette = animation.palette.bytes();
    let mut encoder = Encoder::new(&mut bytes, animation.width, animation.height, &palette)?;
    encoder.set_repeat(Repeat::Infinite)?;
    for Frame { left, top, width, height, pixels, centiseconds } in &animation.frames {
        encoder.write_frame(&gif::Frame {
            delay: *centiseconds,
            dispose: DisposalMethod::Keep,
            transparent: Some(TRANSPARENT),
            left: *left,
            top: *top,
            width: *width,
            height: *height,
            buffer: Cow::Borrowed(pixels),
            ..gif::Frame::default()
        })?;
    }
    drop(encoder);
    Ok(bytes)
}
