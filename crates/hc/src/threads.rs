//! Work on all threads of rayon, or on the only one there is: the functions of rayon that the crate
//! uses, and their replacement without the feature `threads`.
//!
//! Results are the same either way, because they do not depend on the number of threads.

#[cfg(feature = "threads")]
pub(crate) use rayon::{
    Scope, current_num_threads,
    prelude::{IntoParallelIterator, IntoParallelRefIterator, ParallelIterator},
    scope,
};
#[cfg(not(feature = "threads"))]
pub(crate) use serial::{
    IntoParallelIterator, IntoParallelRefIterator, ParallelIterator, Scope, current_num_threads, scope,
};

#[cfg(any(test, not(feature = "threads")))]
mod serial {
    use std::cell::RefCell;

    /// One.
    pub(crate) fn current_num_threads() -> usize {
        1
    }

    /// Iterators that run where they are.
    pub(crate) trait IntoParallelIterator: IntoIterator + Sized {
        /// [`IntoIterator::into_iter`].
        fn into_par_iter(self) -> Self::IntoIter {
            self.into_iter()
        }
    }

    impl<I: IntoIterator> IntoParallelIterator for I {}

    /// Slices that are gone through where they are.
    pub(crate) trait IntoParallelRefIterator<T> {
        /// The iterator of the slice.
        fn par_iter(&self) -> std::slice::Iter<'_, T>;
    }

    impl<T> IntoParallelRefIterator<T> for [T] {
        fn par_iter(&self) -> std::slice::Iter<'_, T> {
            self.iter()
        }
    }

    /// What parallel iterators have and others have not.
    pub(crate) trait ParallelIterator: Iterator + Sized {
        /// [`Iterator::map`] with something that is made once.
        fn map_init<S, R>(
            self,
            make: impl FnOnce() -> S,
            mut map: impl FnMut(&mut S, Self::Item) -> R,
        ) -> impl Iterator<Item = R> {
            let mut state = make();
            self.map(move |item| map(&mut state, item))
        }
    }

    impl<I: Iterator> ParallelIterator for I {}

    /// A task that may leave others behind.
    type Spawned<'s> = Box<dyn FnOnce(&Scope<'s>) + 's>;

    /// Tasks that are still to be run.
    pub(crate) struct Scope<'s> {
        tasks: RefCell<Vec<Spawned<'s>>>,
    }

    impl<'s> Scope<'s> {
        /// Leaves a task for later.
        pub(crate) fn spawn(&self, task: impl FnOnce(&Scope<'s>) + 's) {
            self.tasks.borrow_mut().push(Box::new(task));
        }
    }

    /// Runs a task, and all that it and they leave, the last one first.
    pub(crate) fn scope<'s>(first: impl FnOnce(&Scope<'s>)) {
        let scope = Scope { tasks: RefCell::new(Vec::new()) };
        first(&scope);
        loop {
            let next = scope.tasks.borrow_mut().pop();
            match next {
                Some(task) => task(&scope),
                None => return,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::serial::{IntoParallelIterator, IntoParallelRefIterator, ParallelIterator, current_num_threads, scope};
    use std::cell::RefCell;

    #[test]
    fn one_thread_does_everything() {
        let sums: Vec<u32> = (1..5)
            .into_par_iter()
            .map_init(
                || 0,
                |sum, k| {
                    *sum += k;
                    *sum
                },
            )
            .collect();
        assert_eq!(sums, [1, 3, 6, 10]);
        assert_eq!(sums.par_iter().count(), 4 * current_num_threads());
        let done = RefCell::new(Vec::new());
        scope(|all| {
            done.borrow_mut().push(0);
            for k in [1, 2] {
                let done = &done;
                all.spawn(move |all| {
                    done.borrow_mut().push(k);
                    all.spawn(move |_| done.borrow_mut().push(10 * k));
                });
            }
        });
        assert_eq!(*done.borrow(), [0, 2, 20, 1, 10]);
    }
}
