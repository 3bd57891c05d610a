//! Value, unit and uncertainty of a row, with the bounds beyond which units must have been mixed up.

use super::cells::Cells;
use super::columns::EvidenceColumn;
use super::row::{Quantity, Value};
use crate::shape::{self, Shape};
use crate::words::Named as _;

/// Units by name, with what they are in metres or tonnes.
const LENGTHS: [(&str, f64); 5] = [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("ft", 0.3048), ("in", 0.0254)];
const MASSES: [(&str, f64); 2] = [("t", 1.0), ("kg", 0.001)];

/// What a number can plausibly be, in metres or tonnes.
struct Bounds {
    what: &'static str,
    least: f64,
    most: f64,
    units: &'static [(&'static str, f64)],
}

fn bounds(quantity: Quantity) -> Option<Bounds> {
    let (what, least, most, units): (_, _, _, &[_]) = match quantity {
        Quantity::CarriagewayWidth | Quantity::DirectionWidth | Quantity::LaneWidth => {
            ("width of a road", 0.5, 60.0, &LENGTHS)
        }
        Quantity::KerbRadius => ("radius of a kerb", 0.0, 100.0, &LENGTHS),
        Quantity::MaxHeight => ("height of a vehicle", 0.5, 20.0, &LENGTHS),
        Quantity::MaxWeight => ("mass of a vehicle", 0.1, 500.0, &MASSES),
        Quantity::DrivableBy | Quantity::Surface => return None,
    };
    Some(Bounds { what, least, most, units })
}

impl Bounds {
    fn base(&self) -> &'static str {
        self.units[0].0
    }

    fn holds(&self, value: f64) -> bool {
        (self.least..=self.most).contains(&value)
    }

    /// What is wrong with a value, given as `number` in `unit`.
    fn refusal(&self, number: f64, unit: Option<&str>) -> String {
        let base = self.base();
        let range = format!("({} to {} {base})", self.least, self.most);
        let shown = unit.unwrap_or(base);
        let other = self.units.iter().filter(|_| unit.is_none()).find(|(_, size)| self.holds(number * size));
        match other {
            Some((other, size)) => format!(
                "{number} {shown} is no {} {range}; is it {other} ({} {base})? Then write `{other}` in column `unit`",
                self.what,
                (number * size * 1000.0).round() / 1000.0
            ),
            None => format!("{number} {shown} is no {} {range}; check value and unit", self.what),
        }
    }
}

/// The greatest standard uncertainty of a surface's outline, metres.
const MOST_OUTLINE_M: f64 = 20.0;

/// The value of a row and its standard uncertainty. That of a surface is in metres, of its outline.
pub(super) fn value(cells: &mut Cells, quantity: Quantity) -> Option<(Value, f64)> {
    if quantity != Quantity::DrivableBy {
        cells.refuse_all(&[EvidenceColumn::Vehicle], "belongs to `drivable_by`; leave it empty here");
    }
    match bounds(quantity) {
        Some(bounds) => measured(cells, quantity, &bounds),
        None => {
            let what = format!("`{}` takes none; leave it empty", quantity.name());
            cells.refuse_all(&[EvidenceColumn::Value, EvidenceColumn::Unit], &what);
            if quantity == Quantity::Surface {
                let (value, sigma) = (surface(cells), uncertainty(cells));
                let (value, sigma) = (value?, sigma?);
                if sigma > MOST_OUTLINE_M {
                    let what = format!("{sigma} m is no uncertainty of an outline; give at most {MOST_OUTLINE_M} m");
                    return cells.refuse(EvidenceColumn::Sigma, what);
                }
                return Some((value, sigma));
            }
            cells.refuse_all(&[EvidenceColumn::Sigma], &what);
            vehicle(cells).map(|value| (value, 0.0))
        }
    }
}

fn vehicle(cells: &mut Cells) -> Option<Value> {
    match cells.owned(EvidenceColumn::Vehicle) {
        Some(vehicle) => Some(Value::Vehicle(vehicle)),
        None => cells.refuse(EvidenceColumn::Vehicle, "is empty; give the id of the vehicle (`netcert vehicles list`)"),
    }
}

fn surface(cells: &mut Cells) -> Option<Value> {
    let Some(Shape::Polygon(rings)) = &cells.record.shape else {
        return cells.refuse(EvidenceColumn::Geometry, "a `surface` needs a polygon");
    };
    match shape::rings(rings) {
        Ok(rings) => Some(Value::Polygon(rings)),
        Err(what) => cells.refuse(EvidenceColumn::Geometry, what),
    }
}

fn measured(cells: &mut Cells, quantity: Quantity, bounds: &Bounds) -> Option<(Value, f64)> {
    if !cells.has(EvidenceColumn::Value) {
        return cells.refuse(EvidenceColumn::Value, "is empty; give what was measured, or leave out the row");
    }
    let size = unit(cells, bounds);
    let (number, sigma) = (cells.number(EvidenceColumn::Value), uncertainty(cells));
    let (number, sigma, size) = (number?, sigma?, size?);
    let value = number * size;
    if !bounds.holds(value) {
        let what = bounds.refusal(number, cells.text(EvidenceColumn::Unit));
        return cells.refuse(EvidenceColumn::Value, what);
    }
    if sigma > number {
        let what =
            format!("{sigma} is more than the value, {number}; give the standard uncertainty in the value's unit");
        return cells.refuse(EvidenceColumn::Sigma, what);
    }
    let value = if quantity == Quantity::MaxWeight { Value::Tonnes(value) } else { Value::Metres(value) };
    Some((value, sigma * size))
}

/// The size of the row's unit in metres or tonnes.
fn unit(cells: &mut Cells, bounds: &Bounds) -> Option<f64> {
    let Some(text) = cells.text(EvidenceColumn::Unit) else { return Some(1.0) };
    if let Some(unit) = bounds.units.iter().find(|unit| unit.0.eq_ignore_ascii_case(text)) {
        return Some(unit.1);
    }
    let known: Vec<&str> = bounds.units.iter().map(|unit| unit.0).collect();
    let what = format!("`{}` is no unit of a {}; known are {}", text.escape_debug(), bounds.what, known.join(", "));
    cells.refuse(EvidenceColumn::Unit, what)
}

/// The standard uncertainty in the row's unit.
fn uncertainty(cells: &mut Cells) -> Option<f64> {
    if !cells.has(EvidenceColumn::Sigma) {
        return Some(0.0);
    }
    let sigma = cells.number(EvidenceColumn::Sigma)?;
    if sigma < 0.0 {
        return cells.refuse(EvidenceColumn::Sigma, format!("{sigma} is negative; give the standard uncertainty"));
    }
    Some(sigma)
}
