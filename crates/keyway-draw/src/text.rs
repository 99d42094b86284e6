//! Text widths, to prevent overlaps. No font is read: the widths are those of the bundled one,
//! which is wider than its fallbacks.

/// Size of tick labels, names and legends \[px\].
pub(crate) const SMALL_TEXT_PX: f64 = 11.0;

/// Advance widths of the characters from space to `~` in the font, in thousandths of the size.
const ASCII_WIDTHS: [u16; 95] = [
    318, 401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361, 318, 337, 636, 636, 636,
    636, 636, 636, 636, 636, 636, 636, 337, 337, 838, 838, 838, 531, 1000, 684, 686, 698, 770, 632,
    575, 775, 752, 295, 295, 656, 557, 863, 748, 787, 603, 787, 695, 635, 611, 732, 684, 989, 685,
    611, 685, 390, 337, 390, 838, 500, 500, 613, 635, 550, 635, 615, 352, 635, 634, 278, 278, 579,
    278, 974, 634, 612, 635, 635, 411, 521, 392, 634, 592, 818, 592, 592, 525, 636, 337, 636, 838,
];

/// Width assumed for all other characters: wide enough for Greek, Cyrillic and the minus sign.
const OTHER_WIDTH: u16 = 838;

/// Width of a text \[px\] at a font size; an upper estimate outside ASCII.
pub(crate) fn text_width_px(text: &str, size_px: f64) -> f64 {
    let width = |c: char| {
        let index = (c as usize).checked_sub(' ' as usize);
        index.and_then(|i| ASCII_WIDTHS.get(i)).copied().unwrap_or(OTHER_WIDTH)
    };
    text.chars().map(|c| f64::from(width(c))).sum::<f64>() * size_px / 1000.0
}

#[cfg(all(test, feature = "raster"))]
mod tests {
    use super::*;
    use crate::svg::Svg;
    use crate::writer::{Anchor, SvgWriter};
    use resvg::usvg::Node;

    #[test]
    fn agrees_with_the_bundled_font() {
        for text in ["HMMHxWWWH", "H0123456789.:,;H", "H[m/s] (rad)H", "Hsmoothed pathH"] {
            let mut body = SvgWriter::new();
            body.label(0.0, 30.0, 20.0, Anchor::Start, text);
            let tree = Svg::page(600.0, 50.0, body).tree().unwrap();
            let Node::Group(group) = &tree.root().children()[1] else { panic!("no group") };
            let Node::Text(drawn) = &group.children()[0] else { panic!("no text") };
            let width = f64::from(drawn.bounding_box().width());
            let expected = text_width_px(text, 20.0);
            // Kerning and the side bearings of the outer letters.
            assert!((width - expected).abs() < 6.0, "{text}: {width} drawn, {expected} computed");
        }
    }
}
