//! The search for mixed cells, one support brought in after the other, on all threads.
//!
//! Sending the lifting of `d_k Delta` to minus infinity at stage `k` leaves the mixed cells of
//! `A_0 .. A_k, Delta, ..`. Each of these is a start for the next stage. All stages make one tree,
//! whose subtrees are tasks.

use super::cell::{Cell, EdgeEnd, Flip};
use super::error::{MixedError, Overflow};
use super::integer::Integer;
use super::points::Points;
use super::space::{AnyCell, Size, Space};
use super::walk::{Scratch, Step};
use crate::threads::{self, Scope};
use poly::simd::{Isa, Kernel};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What takes the cells that are found.
pub(super) trait Sink: Send {
    fn take<T: Integer>(&mut self, cell: &Cell<T>) -> Result<(), Overflow>;
}

/// A [`Sink`] for cells of one size of integers. The search knows nothing else of its sink, so that it is
/// compiled only once for each size.
trait TakeCell<T> {
    fn take_cell(&mut self, cell: &Cell<T>) -> Result<(), Overflow>;
}

impl<T: Integer, S: Sink> TakeCell<T> for S {
    fn take_cell(&mut self, cell: &Cell<T>) -> Result<(), Overflow> {
        self.take(cell)
    }
}

/// What is still to be done with a cell before it is searched.
#[derive(Clone, Copy)]
enum Pending {
    Nothing,
    /// To enter its stage.
    Enter,
    Flip(Flip),
}

/// A subtree that has still to be searched: what is to be done with the cell at its root.
#[derive(Clone)]
pub(super) struct SubtreeRoot {
    stage: usize,
    pending: Pending,
    cell: AnyCell,
}

/// Cells that a task visits before it hands over what is left: about a millisecond.
const BUDGET: usize = 1 << 12;
/// Cells that a task visits while the tree is divided: few, so that the subtrees begin high up.
const SMALL_BUDGET: usize = 1 << 5;

impl SubtreeRoot {
    /// The whole tree.
    fn whole(space: &Space) -> Result<SubtreeRoot, Overflow> {
        let cell =
            Cell::<i64>::of_simplices(space.supports.len()).and_then(|cell| space.smallest(&cell)).ok_or(Overflow)?;
        Ok(SubtreeRoot { stage: 0, pending: Pending::Enter, cell })
    }

    /// Visits up to `budget` cells. Returns the subtrees that are left.
    fn run<S: Sink>(self, isa: Isa, space: &Space, budget: usize, sink: &mut S) -> Result<Vec<SubtreeRoot>, Overflow> {
        let SubtreeRoot { stage, pending, cell } = self;
        match cell {
            AnyCell::Small(cell) => Subtree::run(isa, space, stage, cell, sink, (pending, budget)),
            AnyCell::Medium(cell) => Subtree::run(isa, space, stage, cell, sink, (pending, budget)),
            AnyCell::Large(cell) => Subtree::run(isa, space, stage, cell, sink, (pending, budget)),
        }
    }
}

/// Finds all cells. Which sink takes which cell, and in what order, depends on the threads.
///
/// # Errors
/// If integers exceed all sizes, or the search has been cancelled before its end.
pub(super) fn search<S: Sink>(space: &Space, sink: impl Fn() -> S + Sync) -> Result<Vec<S>, MixedError> {
    search_in(space, SubtreeRoot::whole(space)?, sink)
}

/// [`search`] in a subtree.
///
/// # Errors
/// Those of [`search`].
pub(super) fn search_in<S: Sink>(
    space: &Space,
    task: SubtreeRoot,
    sink: impl Fn() -> S + Sync,
) -> Result<Vec<S>, MixedError> {
    let state = SearchState {
        space,
        sink,
        isa: Isa::detect(),
        sinks: Mutex::new(Vec::new()),
        overflow: AtomicBool::new(false),
        cancelled: AtomicBool::new(false),
    };
    threads::scope(|scope| state.run(scope, task));
    if state.overflow.into_inner() {
        return Err(MixedError::TooLarge);
    }
    if state.cancelled.into_inner() {
        return Err(MixedError::Cancelled);
    }
    Ok(state.sinks.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// Divides the tree into at least so many subtrees, unless it is smaller; cells that are found on the way
/// go to the sink. The division is the same on every machine.
///
/// # Errors
/// Those of [`search`].
pub(super) fn divided<S: Sink>(space: &Space, least: usize, sink: &mut S) -> Result<Vec<SubtreeRoot>, MixedError> {
    let isa = Isa::detect();
    let mut tasks = VecDeque::from([SubtreeRoot::whole(space)?]);
    while tasks.len() < least
        && let Some(task) = tasks.pop_front()
    {
        if space.monitor.is_cancelled() {
            return Err(MixedError::Cancelled);
        }
        tasks.extend(task.run(isa, space, SMALL_BUDGET, sink)?);
    }
    Ok(tasks.into())
}

struct SearchState<'a, S, F> {
    space: &'a Space,
    sink: F,
    isa: Isa,
    /// Sinks that no task has at present, as many as there are threads at most.
    sinks: Mutex<Vec<S>>,
    overflow: AtomicBool,
    /// Whether a task was dropped because the search has been cancelled.
    cancelled: AtomicBool,
}

impl<S: Sink, F: Fn() -> S + Sync> SearchState<'_, S, F> {
    fn idle(&self) -> MutexGuard<'_, Vec<S>> {
        self.sinks.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn run<'s>(&'s self, scope: &Scope<'s>, task: SubtreeRoot) {
        if self.overflow.load(Ordering::Relaxed) {
            return;
        }
        if self.space.monitor.is_cancelled() {
            self.cancelled.store(true, Ordering::Relaxed);
            return;
        }
        let idle = self.idle().pop();
        let mut sink = idle.unwrap_or_else(&self.sink);
        let handed = task.run(self.isa, self.space, BUDGET, &mut sink);
        self.idle().push(sink);
        match handed {
            Ok(tasks) => tasks.into_iter().for_each(|task| scope.spawn(move |scope| self.run(scope, task))),
            Err(Overflow) => self.overflow.store(true, Ordering::Relaxed),
        }
    }
}

/// A task in one size of integers.
struct Subtree<'a, T> {
    space: &'a Space,
    points: &'a Points<T>,
    stage: usize,
    cell: Cell<T>,
    sink: &'a mut dyn TakeCell<T>,
    scratch: Scratch<T>,
    /// Cells still to be visited, and memory for more.
    stack: Vec<(usize, Cell<T>)>,
    spare: Vec<Cell<T>>,
    handed: Vec<SubtreeRoot>,
}

impl<'a, T: Size> Subtree<'a, T> {
    fn run(
        isa: Isa,
        space: &'a Space,
        stage: usize,
        cell: Cell<T>,
        sink: &'a mut dyn TakeCell<T>,
        (pending, budget): (Pending, usize),
    ) -> Result<Vec<SubtreeRoot>, Overflow> {
        let points = T::points(space).ok_or(Overflow)?;
        let scratch = Scratch::new(points);
        let (stack, spare, handed) = (Vec::new(), Vec::new(), Vec::new());
        let tree = Subtree { space, points, stage, cell, sink, scratch, stack, spare, handed };
        isa.run(Search { tree, pending, budget })
    }

    /// Hands the current cell over to a task in larger integers.
    fn promote(&mut self, pending: Pending) -> Result<(), Overflow> {
        if T::LAST {
            return Err(Overflow);
        }
        let points = T::Next::points(self.space).ok_or(Overflow)?;
        let cell = T::Next::any(self.cell.converted(points).ok_or(Overflow)?);
        self.handed.push(SubtreeRoot { stage: self.stage, pending, cell });
        Ok(())
    }

    /// Puts the second child on the stack.
    #[inline(always)]
    fn push(&mut self, flip: Flip) -> Result<(), Overflow> {
        let mut other = match self.spare.pop() {
            Some(mut cell) => {
                cell.assign(&self.cell);
                cell
            }
            None => self.cell.clone(),
        };
        if other.flip(self.points, flip, &self.scratch.circuit).is_err() {
            self.spare.push(other);
            return self.promote(Pending::Flip(flip));
        }
        self.stack.push((self.stage, other));
        Ok(())
    }

    /// Enters the stage; returns whether the cell still belongs to this task.
    fn enter(&mut self) -> Result<bool, Overflow> {
        if self.cell.enter(self.points, self.stage).is_err() {
            self.promote(Pending::Enter)?;
            return Ok(false);
        }
        Ok(true)
    }

    /// Moves on to the next cell; returns whether there is one.
    #[inline(always)]
    fn step(&mut self) -> Result<bool, Overflow> {
        let n = self.points.n;
        let found = match &self.space.tau {
            Some(tau) if self.stage == n => self.scratch.lift(self.points, tau, &self.cell),
            _ => self.scratch.regenerate(self.points, self.stage, &self.cell),
        };
        match found {
            Err(Overflow) => self.promote(Pending::Nothing)?,
            Ok(Step::Arrived) if self.stage == n => self.sink.take_cell(&self.cell)?,
            Ok(Step::Arrived) => {
                self.cell.leave(self.points, self.stage);
                self.stage += 1;
                if self.stage < n {
                    if self.enter()? {
                        return Ok(true);
                    }
                } else if self.space.tau.is_some() {
                    return Ok(true);
                } else {
                    self.sink.take_cell(&self.cell)?;
                }
            }
            Ok(Step::Ends { column, children: [first, second] }) => {
                if second {
                    let flip = Flip { end: EdgeEnd::Second, column };
                    if first {
                        self.push(flip)?;
                    } else if self.cell.flip(self.points, flip, &self.scratch.circuit).is_ok() {
                        return Ok(true);
                    } else {
                        self.promote(Pending::Flip(flip))?;
                    }
                }
                if first {
                    let flip = Flip { end: EdgeEnd::First, column };
                    if self.cell.flip(self.points, flip, &self.scratch.circuit).is_ok() {
                        return Ok(true);
                    }
                    self.promote(Pending::Flip(flip))?;
                }
            }
        }
        let Some((stage, cell)) = self.stack.pop() else { return Ok(false) };
        self.stage = stage;
        self.spare.push(std::mem::replace(&mut self.cell, cell));
        Ok(true)
    }
}

struct Search<'a, T> {
    tree: Subtree<'a, T>,
    pending: Pending,
    budget: usize,
}

impl<T: Size> Kernel for Search<'_, T> {
    type Output = Result<Vec<SubtreeRoot>, Overflow>;
    const WIDEST: Isa = T::WIDEST;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let mut tree = self.tree;
        let mut more = match self.pending {
            Pending::Nothing => true,
            Pending::Enter => tree.enter()?,
            Pending::Flip(flip) => {
                tree.cell.circuit(tree.points, tree.stage, flip.column, 0, &mut tree.scratch.circuit);
                let done = tree.cell.flip(tree.points, flip, &tree.scratch.circuit).is_ok();
                if !done {
                    tree.promote(self.pending)?;
                }
                done
            }
        };
        let mut budget = self.budget;
        while more && budget > 0 {
            more = tree.step()?;
            budget -= 1;
        }
        if more {
            tree.stack.push((tree.stage, tree.cell));
        }
        let left = tree.stack.into_iter().map(|(stage, cell)| SubtreeRoot {
            stage,
            pending: Pending::Nothing,
            cell: T::any(cell),
        });
        tree.handed.extend(left);
        Ok(tree.handed)
    }
}
