//! Numbers read back from a picture: what a chart shows, worked out from its own ticks.

use super::Page;
use serde_json::Value;

impl Page {
    /// What a series shows: pairs of x and y in the units of the axes. The y axis is told by the
    /// texts of its ticks, the x axis by its range.
    ///
    /// # Panics
    ///
    /// If there is no such chart or series.
    pub async fn drawn(&self, chart: &str, series: &str) -> Vec<(f64, f64)> {
        let script = format!(
            "const svg = document.querySelector('[data-chart=\"{chart}\"] [data-testid=chart-svg]');
             const ticks = [...svg.querySelectorAll('text[data-tick=y]')].map(t =>
               [Number(t.getAttribute('y')) - 4,
                Number(t.textContent.replaceAll('\\u2009', '').replace('\\u2212', '-'))]);
             const [a, b] = [ticks[0], ticks[ticks.length - 1]];
             const y = p => a[1] + (p - a[0]) / (b[0] - a[0]) * (b[1] - a[1]);
             const [left, , width] = svg.dataset.plot.split(' ').map(Number);
             const [low, high] = svg.dataset.x.split(' ').map(Number);
             const x = p => low + (p - left) / width * (high - low);
             const path = svg.querySelector('path[data-series=\"{series}\"]');
             if (path) {{
               const points = [];
               for (const [, x1, y1, x2] of path.getAttribute('d')
                      .matchAll(/[ML](-?[\\d.]+) (-?[\\d.]+)(?:H(-?[\\d.]+))?/g)) {{
                 const middle = x2 === undefined ? Number(x1) : (Number(x1) + Number(x2)) / 2;
                 points.push([x(middle), y(Number(y1))]);
               }}
               return points;
             }}
             return [...svg.querySelectorAll('rect[data-series=\"{series}\"]')].map(r => {{
               const n = name => Number(r.getAttribute(name));
               const ends = [y(n('y')), y(n('y') + n('height'))];
               // A bar stands on zero or hangs from it.
               const value = Math.abs(ends[0]) > Math.abs(ends[1]) ? ends[0] : ends[1];
               return [x(n('x') + n('width') / 2), value];
             }});"
        );
        let found = self.eval(&script).await;
        let pair = |p: &Value| Some((p.get(0)?.as_f64()?, p.get(1)?.as_f64()?));
        let points = found.as_array().expect("points").iter();
        points.map(|p| pair(p).expect("two numbers")).collect()
    }

    /// Holds that a series shows these values, within what a pixel can say.
    ///
    /// # Panics
    ///
    /// If it shows others, more or fewer.
    pub async fn assert_shows(&self, chart: &str, series: &str, wanted: &[f64]) {
        let points = self.drawn(chart, series).await;
        let span = wanted.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
        // A bar is seen however small it is, so it may be a pixel and a half too long.
        let bars = format!("[data-chart=\"{chart}\"] rect[data-series]");
        let bars = self.count(&bars).await > 0;
        let within = span * if bars { 0.008 } else { 0.006 } + 0.05;
        assert_eq!(points.len(), wanted.len(), "{chart} {series}: {points:?}");
        for ((_, y), wanted) in points.iter().zip(wanted) {
            assert!(
                (y - wanted).abs() < within,
                "{chart} {series}: {y} instead of {wanted}"
            );
        }
    }
}
