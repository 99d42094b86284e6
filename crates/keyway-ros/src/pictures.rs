//! Costmaps for display, drawn in a separate thread: control never waits for them.

use crate::costmaps::{Known, Shown};
use crate::messages::nav_msgs::OccupancyGrid;
use crate::messages::std_msgs::Header;
use keyway::geometry::Point;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

/// A drawing order.
pub(crate) struct Order {
    pub(crate) shown: Shown,
    pub(crate) known: Known,
    /// Position of the robot.
    pub(crate) place: Point,
    pub(crate) header: Header,
}

impl Order {
    fn draw(self) -> Option<(Shown, OccupancyGrid)> {
        let window = self.known.window(self.shown, self.place);
        Some((self.shown, self.known.costs(window)?.grid(self.header)))
    }
}

/// The drawing thread.
pub(crate) struct Pictures {
    orders: SyncSender<Order>,
    drawn: Receiver<(Shown, OccupancyGrid)>,
}

impl Pictures {
    /// Starts the thread; it ends when this value is dropped.
    pub(crate) fn new() -> std::io::Result<Self> {
        let (orders, received) = sync_channel::<Order>(2);
        let (sent, drawn) = sync_channel(4);
        std::thread::Builder::new().name("pictures".to_owned()).spawn(move || {
            for picture in received.into_iter().filter_map(Order::draw) {
                if sent.send(picture).is_err() {
                    break;
                }
            }
        })?;
        Ok(Self { orders, drawn })
    }

    /// Sends an order, unless too many are waiting.
    pub(crate) fn order(&self, order: Order) {
        drop(self.orders.try_send(order));
    }

    /// All pictures drawn since the last call.
    pub(crate) fn take_all(&self) -> impl Iterator<Item = (Shown, OccupancyGrid)> + '_ {
        self.drawn.try_iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::Robot;
    use keyway::geometry::Pose;
    use keyway::map::GridFrame;
    use keyway::navigate::{Navigator, Stack};
    use std::time::Duration;

    fn size(shown: Shown, cells: u64) -> (u32, u32) {
        let robot = Robot::small();
        let frame = GridFrame::new(cells, 50, 0.05, Pose::default()).unwrap();
        let map = keyway::OccupancyGrid::all_free(frame);
        let stack = Stack::keyway(&robot).fit(&robot).unwrap();
        let known = Known::of(&Navigator::new(&map, &stack).unwrap());
        let pictures = Pictures::new().unwrap();
        let header = Header::new(1.0, "map");
        pictures.order(Order { shown, known, place: Point::new(30.01, 1.01), header });
        let (drawn, grid) = pictures.drawn.recv_timeout(Duration::from_secs(20)).unwrap();
        assert_eq!(drawn, shown);
        (grid.info.width, grid.info.height)
    }

    #[test]
    fn a_local_one_is_around_the_robot_and_a_global_one_as_large_as_can_be() {
        assert_eq!(size(Shown::Local, 900), (121, 50));
        assert_eq!(size(Shown::Global, 230), (230, 50), "all of it");
        assert_eq!(size(Shown::Global, 2000), (400, 50), "a part around the robot");
    }
}
