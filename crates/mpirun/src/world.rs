//! MPI, which only the first thread of the program calls: it carries messages while another one
//! works.
//!
//! MPI's own waiting would take a processor from the work. Instead one looks for messages every
//! millisecond, and sleeps in between.

use super::carrier::{Addressed, Station, both};
use hc::ranks::Exchange;
use mpi::Threading;
use mpi::point_to_point::Status;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Destination, Equivalence, Source};
use std::process::ExitCode;
use std::sync::mpsc::Sender;
use std::time::Duration;

/// What launchers of MPI tell their processes by: Open MPI, MPICH and Intel MPI, Slurm and others,
/// MVAPICH. Without one of these MPI is not asked, so that the program starts as fast as ever.
const LAUNCHERS: [&str; 5] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMI_RANK", "PMIX_RANK", "MV2_COMM_WORLD_SIZE"];
/// How long one sleeps before looking for messages again.
const POLL: Duration = Duration::from_millis(1);
/// Longer messages are not of this program.
const LONGEST: usize = (1 << 30) + 1;
/// Memory for the calls of the thread that works: as much as the first one has.
const STACK: usize = 8 << 20;
/// Exit status of a program that has panicked.
const PANICKED: i32 = 101;

/// Tags of messages: one for the work, one for the last message of a rank.
const WORK: i32 = 1;
const LAST: i32 = 2;

/// Runs the program of this name, with what carries messages to other ranks if there are any.
pub(crate) fn with(name: &str, work: impl FnOnce(Option<&dyn Exchange>) -> ExitCode + Send) -> ExitCode {
    if !LAUNCHERS.iter().any(|name| std::env::var_os(name).is_some()) {
        return work(None);
    }
    let Some((universe, threading)) = mpi::initialize_with_threading(Threading::Funneled) else {
        return work(None);
    };
    let world = universe.world();
    let [rank, count] = [world.rank(), world.size()].map(|number| usize::try_from(number).unwrap_or(0));
    if threading < Threading::Funneled {
        if rank == 0 {
            eprintln!("{name}: this MPI lets no program have threads; use another one");
        }
        return ExitCode::from(2);
    }
    let (carrier, station) = both(rank, count);
    let ended = std::thread::scope(|scope| {
        let exchange = (count > 1).then_some(&carrier as &dyn Exchange);
        let thread = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, move || work(exchange));
        let Ok(thread) = thread else { return None };
        let mut post = Post { world: &world, rank, others: count - 1, station };
        post.carry(|| thread.is_finished());
        thread.join().ok()
    });
    // A rank that cannot go on ends all: they would wait for it.
    ended.unwrap_or_else(|| world.abort(PANICKED))
}

/// Carries messages between the work and MPI.
struct Post<'a> {
    world: &'a SimpleCommunicator,
    rank: usize,
    /// Ranks that may still send something to rank 0.
    others: usize,
    station: Station,
}

impl Post<'_> {
    /// Carries messages until the work has finished and all that it has sent is on its way; at rank 0
    /// also until all others have ended, as a long message leaves only where it is received.
    fn carry(&mut self, finished: impl Fn() -> bool) {
        loop {
            let last = finished();
            while let Some(message) = self.next(if last { Duration::ZERO } else { POLL }) {
                self.send(&message);
                self.receive();
            }
            self.receive();
            if last && self.rank > 0 {
                return self.world.process_at_rank(0).send_with_tag(&[0u8][..], LAST);
            }
            if last && self.others == 0 {
                return;
            }
            if last {
                std::thread::sleep(POLL);
            }
        }
    }

    /// The next message that the work sends.
    fn next(&self, wait: Duration) -> Option<Addressed> {
        self.station.out.recv_timeout(wait).ok()
    }

    /// Sends a message. Others are received until it has left: two ranks that send to each other would
    /// wait for ever.
    fn send(&mut self, (to, message): &Addressed) {
        let Ok(to) = i32::try_from(*to) else { return };
        mpi::request::scope(|scope| {
            let mut request = self.world.process_at_rank(to).immediate_send_with_tag(scope, &message[..], WORK);
            loop {
                match request.test() {
                    Ok(_) => return,
                    Err(same) => request = same,
                }
                if !receive(self.world, &self.station.arrived, &mut self.others) {
                    std::thread::sleep(POLL / 10);
                }
            }
        });
    }

    /// Receives what is there.
    fn receive(&mut self) {
        while receive(self.world, &self.station.arrived, &mut self.others) {}
    }
}

/// Receives a message, if there is one.
fn receive(world: &SimpleCommunicator, arrived: &Sender<Addressed>, others: &mut usize) -> bool {
    let Some((message, status)) = world.any_process().immediate_matched_probe() else { return false };
    let mut bytes = vec![0u8; length(&status)];
    let _ = message.matched_receive_into(&mut bytes[..]);
    if status.tag() == LAST {
        *others = others.saturating_sub(1);
    } else if let Ok(from) = usize::try_from(status.source_rank()) {
        // Work that has finished needs nothing more.
        let _ = arrived.send((from, bytes));
    }
    true
}

/// How long a message is. One that is too long is cut off by MPI, which ends the run.
fn length(status: &Status) -> usize {
    usize::try_from(status.count(u8::equivalent_datatype())).unwrap_or(0).min(LONGEST)
}
