//! Who holds a connection, so that one that says nothing never stands in the way of one that may stop the robots.
//!
//! Each kind of holder has places of its own. A newcomer always gets one: the oldest of its kind goes.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::{Notify, oneshot};

/// What is known of the other side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Holder {
    /// Has not completed the head of a request, or is being refused
    Nobody,
    /// May read: on a loopback address anybody, elsewhere with a token
    Reader,
    /// Has shown the token with which the robots are stopped
    Controller,
}

impl Holder {
    pub(super) const fn places(self) -> usize {
        match self {
            Self::Nobody => 256,
            Self::Reader => 64,
            Self::Controller => 32,
        }
    }
}

#[derive(Default)]
pub(super) struct Places {
    open: Mutex<Open>,
    left: Notify,
}

/// Numbers grow, so that the first is the oldest.
#[derive(Default)]
struct Open {
    next: u64,
    held: BTreeMap<u64, (Holder, oneshot::Sender<()>)>,
}

impl Open {
    fn make_room(&mut self, holder: Holder) {
        let same = self.held.iter().filter(|(_, (other, _))| *other == holder);
        let same: Vec<u64> = same.map(|(number, _)| *number).collect();
        if same.len() >= holder.places() {
            self.evict(same[0]);
        }
    }

    /// Dropping the sender tells the connection.
    fn evict(&mut self, number: u64) {
        self.held.remove(&number);
    }
}

impl Places {
    /// A place for a new connection, and what ends when it has to go.
    pub(super) fn enter(self: &Arc<Self>) -> (Place, oneshot::Receiver<()>) {
        let (sender, evicted) = oneshot::channel();
        let mut open = self.lock();
        open.make_room(Holder::Nobody);
        let number = open.next;
        open.next += 1;
        open.held.insert(number, (Holder::Nobody, sender));
        drop(open);
        let places = Arc::clone(self);
        (Place { places, number }, evicted)
    }

    /// The oldest that has said nothing goes, where the system has no room for another connection.
    pub(super) fn evict_oldest(&self) {
        let mut open = self.lock();
        let mut nobodies = open.held.iter();
        let oldest = nobodies.find(|(_, (holder, _))| *holder == Holder::Nobody);
        if let Some(number) = oldest.map(|(number, _)| *number) {
            open.evict(number);
        }
    }

    /// Until all who were let in have their last event.
    pub(super) async fn until_empty(&self) {
        loop {
            let left = self.left.notified();
            let inside = |(holder, _): &(Holder, _)| *holder != Holder::Nobody;
            if !self.lock().held.values().any(inside) {
                return;
            }
            left.await;
        }
    }

    fn lock(&self) -> MutexGuard<'_, Open> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Given back when dropped.
pub(super) struct Place {
    places: Arc<Places>,
    number: u64,
}

impl Place {
    /// The head of the request is there, and says who this is.
    pub(super) fn let_in(&self, holder: Holder) {
        let mut open = self.places.lock();
        let Some((_, sender)) = open.held.remove(&self.number) else {
            return;
        };
        open.make_room(holder);
        open.held.insert(self.number, (holder, sender));
    }

    pub(super) fn is_inside(&self) -> bool {
        let open = self.places.lock();
        let own = open.held.get(&self.number);
        own.is_some_and(|(holder, _)| *holder != Holder::Nobody)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.places.lock().held.remove(&self.number);
        self.places.left.notify_one();
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn is_evicted(evicted: &mut oneshot::Receiver<()>) -> bool {
        evicted.try_recv() == Err(oneshot::error::TryRecvError::Closed)
    }

    #[test]
    fn the_oldest_of_the_same_kind_goes() {
        let places = Arc::new(Places::default());
        let (controller, mut stays) = places.enter();
        controller.let_in(Holder::Controller);
        let mut entered: Vec<_> = (0..=Holder::Nobody.places())
            .map(|_| places.enter())
            .collect();
        assert!(is_evicted(&mut entered[0].1), "the oldest");
        assert!(!is_evicted(&mut entered[1].1));
        assert!(!is_evicted(&mut stays), "has a token");
        for (place, _) in &entered[1..=Holder::Reader.places() + 1] {
            place.let_in(Holder::Reader);
        }
        assert!(is_evicted(&mut entered[1].1), "the oldest reader");
        assert!(!is_evicted(&mut entered[2].1));
        assert!(entered[2].0.is_inside() && !entered[1].0.is_inside());
        places.evict_oldest();
        let first_nobody = Holder::Reader.places() + 2;
        assert!(is_evicted(&mut entered[first_nobody].1));
        drop(entered);
        assert_eq!(places.lock().held.len(), 1);
    }
}
