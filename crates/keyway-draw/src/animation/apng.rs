//! Frames as APNG.

use super::{Animation, Frame};
use crate::raster::DrawError;
use png::{BitDepth, BlendOp, ColorType, Compression, Encoder, EncodingError, Filter};

pub(super) fn encode(animation: &Animation) -> Result<Vec<u8>, DrawError> {
    write(animation).map_err(|error| DrawError::Png(error.to_string()))
}

fn write(animation: &Animation) -> Result<Vec<u8>, EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, animation.width.into(), animation.height.into());
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_palette(animation.palette.bytes());
    encoder.set_trns(opacities());
    encoder.set_compression(Compression::High);
    // Set last, because setting the compression chooses a filter, too. Neighbouring palette
    // indices have nothing in common that a filter could use.
    encoder.set_filter(Filter::NoFilter);
    // 0: loop for ever.
    encoder.set_animated(animation.frames.len() as u32, 0)?;
    encoder.set_blend_op(BlendOp::Over)?;
    let mut writer = encoder.write_header()?;
    for Frame { left, top, width, height, pixels, centiseconds } in &animation.frames {
        writer.set_frame_delay(*centiseconds, 100)?;
        writer.reset_frame_position()?;
        writer.set_frame_dimension((*width).into(), (*height).into())?;
        writer.set_frame_position((*left).into(), (*top).into())?;
        writer.write_image_data(pixels)?;
    }
    writer.finish()?;
    Ok(bytes)
}

/// Opacities of the palette: only the last entry is transparent.
fn opacities() -> Vec<u8> {
    let mut opacities = vec![255; 256];
    opacities[usize::from(super::TRANSPARENT)] = 0;
    opacities
}
