//! From the mixed cells of one lifting to those of another by flips, depth first and without a list of visited cells.

use super::integer::Integer;
use super::table::{Layout, Overflow, Place, Table};

/// A flip that is to be undone.
struct Flip {
    config: usize,
    place: Place,
    /// The column that was replaced.
    old: usize,
    /// The other child, still to be visited: its column.
    other: Option<usize>,
}

/// A cell in either size of integers.
pub(super) enum AnyTable {
    Small(Table<i64>),
    Large(Table<i128>),
}

impl AnyTable {
    /// In the smallest size that holds it.
    pub(super) fn new(pairs: Vec<[usize; 2]>, volume: i128, entries: &[i128]) -> Result<Self, Overflow> {
        match Table::new(pairs.clone(), volume, entries) {
            Ok(table) => Ok(AnyTable::Small(table)),
            Err(Overflow) => Table::new(pairs, volume, entries).map(AnyTable::Large),
        }
    }

    /// Carries the cell from the symbolic lifting to infinity in the direction `tau`; `emit` is called for every cell that arrives.
    pub(super) fn walk(
        self,
        layout: &Layout,
        tau: &[i64],
        emit: &mut dyn FnMut(&Table<i128>) -> Result<(), Overflow>,
    ) -> Result<(), Overflow> {
        match self {
            AnyTable::Small(table) => walk(table, layout, tau, emit),
            AnyTable::Large(table) => walk(table, layout, tau, emit),
        }
    }
}

fn walk<T: Integer>(
    mut table: Table<T>,
    layout: &Layout,
    tau: &[i64],
    emit: &mut dyn FnMut(&Table<i128>) -> Result<(), Overflow>,
) -> Result<(), Overflow> {
    let is_widest = T::LIMIT == <i128 as Integer>::LIMIT;
    let mut dots = Vec::new();
    let mut flips: Vec<Flip> = Vec::new();
    loop {
        // Forward to a cell that arrives, or to one without children.
        let found = match table.first_violated(layout, tau, &mut dots) {
            Ok(found) => found,
            Err(Overflow) if is_widest => return Err(Overflow),
            Err(Overflow) => {
                walk(table.widened(), layout, tau, emit)?;
                if !back(&mut table, layout, tau, &mut flips, emit)? {
                    return Ok(());
                }
                continue;
            }
        };
        let moved = match found {
            None => {
                emit(&table.widened())?;
                false
            }
            Some(g) => {
                let i = layout.config[g];
                let [first, second] = children(&table, i, g);
                match (first, second) {
                    (false, false) => false,
                    (true, both) => flip(&mut table, layout, tau, &mut flips, emit, (i, Place::First, g), both)?,
                    (false, true) => flip(&mut table, layout, tau, &mut flips, emit, (i, Place::Second, g), false)?,
                }
            }
        };
        if !moved && !back(&mut table, layout, tau, &mut flips, emit)? {
            return Ok(());
        }
    }
}

/// Which children a cell has when column `g` of configuration `i` enters: with the first, with the second of its pair replaced.
///
/// A child with two parents belongs to the one of them whose column stands first.
fn children<T: Integer>(table: &Table<T>, i: usize, g: usize) -> [bool; 2] {
    let [a, b] = table.pairs[i];
    let c_a = table.entry(g, i);
    let c_b = table.volume.wide() - c_a;
    [c_a > 0 && (c_b >= 0 || b < g), c_b > 0 && (c_a >= 0 || a < g)]
}

/// Goes to a child, or visits its subtree in larger integers where it needs them; whether `table` has moved.
fn flip<T: Integer>(
    table: &mut Table<T>,
    layout: &Layout,
    tau: &[i64],
    flips: &mut Vec<Flip>,
    emit: &mut dyn FnMut(&Table<i128>) -> Result<(), Overflow>,
    (i, place, g): (usize, Place, usize),
    both: bool,
) -> Result<bool, Overflow> {
    let old = table.pairs[i][usize::from(place == Place::Second)];
    if table.pivot(layout, i, place, g).is_ok() {
        flips.push(Flip { config: i, place, old, other: both.then_some(g) });
        return Ok(true);
    }
    if T::LIMIT == <i128 as Integer>::LIMIT {
        return Err(Overflow);
    }
    let mut wide = table.widened();
    wide.pivot(layout, i, place, g)?;
    walk(wide, layout, tau, emit)?;
    if both { flip(table, layout, tau, flips, emit, (i, Place::Second, g), false) } else { Ok(false) }
}

/// Undoes flips up to one with another child and goes there; false at the end.
fn back<T: Integer>(
    table: &mut Table<T>,
    layout: &Layout,
    tau: &[i64],
    flips: &mut Vec<Flip>,
    emit: &mut dyn FnMut(&Table<i128>) -> Result<(), Overflow>,
) -> Result<bool, Overflow> {
    while let Some(last) = flips.pop() {
        table.pivot(layout, last.config, last.place, last.old)?;
        if let Some(g) = last.other
            && flip(table, layout, tau, flips, emit, (last.config, Place::Second, g), false)?
        {
            return Ok(true);
        }
    }
    Ok(false)
}
