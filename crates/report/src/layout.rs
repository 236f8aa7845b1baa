//! The layout of a page, and its defects.

use crate::canvas::layout;
use crate::error::ReportError;
use crate::figure::Figure;
use crate::layout_record::{Layout, NamedCurve};
use crate::{animation::Animation, png};

/// A curve in a legend counts as visible if this area of it, in square pixels, is visible: the length of three letters.
const MIN_VISIBLE: f64 = 100.0;
/// Or this fraction of it, which suffices for a pin or a single marker.
const MIN_VISIBLE_SHARE: f64 = 0.2;
/// Boxes of words that overlap by less than this, in pixels, only touch.
const TOUCH: f64 = 0.5;

impl Layout {
    /// The layout of a figure, as it is drawn.
    ///
    /// # Errors
    /// [`ReportError::Size`] if the page is too large.
    pub fn of(figure: &Figure) -> Result<Self, ReportError> {
        let page = png::page_of(figure)?;
        Ok(layout(page.size(), |canvas| page.draw(canvas)))
    }

    /// The layout of every frame of an animation. All frames share one legend, so each counts what is seen of a curve in the
    /// frame that shows most of it.
    ///
    /// # Errors
    /// As [`Animation::gif`].
    pub fn of_animation(animation: &Animation) -> Result<Vec<Self>, ReportError> {
        let mut frames = animation.layouts()?;
        let mut largest: Vec<NamedCurve> = Vec::new();
        for curve in frames.iter().flat_map(|frame| &frame.curves) {
            match largest
                .iter_mut()
                .find(|c| c.name == curve.name && c.plot == curve.plot)
            {
                Some(known) if known.visible < curve.visible => *known = curve.clone(),
                Some(_) => {}
                None => largest.push(curve.clone()),
            }
        }
        frames
            .iter_mut()
            .for_each(|frame| frame.curves.clone_from(&largest));
        Ok(frames)
    }

    /// The defects of the layout: overlapping words, words or lines that are cut off, a legend entry without visible curve, and omitted
    /// words. Empty if there are none.
    pub fn defects(&self) -> Vec<String> {
        let mut defects = self.words_on_words();
        defects.extend(self.cut());
        defects.extend(self.legends_without_a_curve());
        let left_out = self.left_out.iter();
        defects.extend(left_out.map(|text| format!("no room for `{text}`")));
        defects
    }

    fn words_on_words(&self) -> Vec<String> {
        let mut defects = Vec::new();
        for (i, one) in self.labels.iter().enumerate() {
            for other in &self.labels[..i] {
                let [a, b] = [one.area, other.area];
                let apart = |k: usize| a[k] + TOUCH > b[k + 2] || b[k] + TOUCH > a[k + 2];
                if !apart(0) && !apart(1) {
                    defects.push(format!("`{}` lies on `{}`", one.text, other.text));
                }
            }
        }
        defects
    }

    fn cut(&self) -> Vec<String> {
        let [width, height] = self.page;
        let outside =
            |[x0, y0, x1, y1]: [f64; 4]| x0 < 0.0 || y0 < 0.0 || x1 > width || y1 > height;
        let labels = self.labels.iter().filter(|label| outside(label.area));
        let mut defects: Vec<String> = labels.map(|l| format!("`{}` is cut", l.text)).collect();
        if outside(self.drawn) {
            defects.push(format!("something is drawn outside: {:?}", self.drawn));
        }
        defects
    }

    fn legends_without_a_curve(&self) -> Vec<String> {
        let mut defects = Vec::new();
        for (plot, name) in &self.legend {
            let curves = self.curves.iter();
            let own = curves.filter(|c| c.plot == *plot && c.name == *name);
            let is_visible = |c: &NamedCurve| {
                c.visible >= MIN_VISIBLE || c.visible > MIN_VISIBLE_SHARE * c.drawn.max(1.0)
            };
            let own: Vec<&NamedCurve> = own.collect();
            if !own.iter().any(|c| is_visible(c)) {
                let areas: Vec<String> = own
                    .iter()
                    .map(|c| format!("{:.0} of {:.0}", c.visible, c.drawn))
                    .collect();
                let areas = areas.join(", ");
                defects.push(format!(
                    "legend entry `{name}` has no visible curve ({areas} px²)"
                ));
            }
        }
        defects
    }
}
