//! Snapshots of a navigator.

use super::guarding::Guard;
use super::stored_record::StoredRecord;
use super::{Errand, Navigator, Record};
use crate::ConfigError;
use crate::local::Scratch;
use crate::navigate::mode::Mode;
use crate::navigate::world::World;
use crate::navigate::{FittedStack, RestoreError, Snapshot};

impl Navigator {
    /// The complete state as a value. Costs a copy of the map and of the layers derived from
    /// sensed obstacles.
    pub fn snapshot(&self) -> Snapshot {
        let Self { parts, world, errand, record, .. } = self;
        let Record { evaluation, guard, counts, .. } = record;
        let record =
            StoredRecord { evaluation: evaluation.clone(), guard: guard.stored(), counts: *counts };
        Snapshot {
            form: Snapshot::FORM,
            robot: (*parts.robot).clone(),
            stack: (*parts.stack).clone(),
            world: world.stored(),
            errand: errand.clone(),
            record,
            speed_limit_mps: self.speed_limit_mps,
            // A pose that is not finite is stored as unknown.
            place: self.place.filter(|it| it.point().is_finite() && it.theta.is_finite()),
            stepped: self.stepped,
            unobserved: self.unobserved,
            issued: self.issued,
        }
    }

    /// Restores a stored navigator. It gives the same commands from here on.
    ///
    /// # Errors
    /// Returns [`RestoreError`] if the snapshot has another format, its robot or stack cannot be
    /// used, or its parts contradict each other.
    pub fn restore(snapshot: Snapshot) -> Result<Self, RestoreError> {
        let stack = snapshot.stack.fit(&snapshot.robot)?;
        Self::restore_with(snapshot, &stack)
    }

    /// Like [`Self::restore`], for a stack with custom parts, which are not stored. The robot and
    /// the parameters of the snapshot are then ignored.
    ///
    /// # Errors
    /// As for [`Self::restore`].
    pub fn restore_with(snapshot: Snapshot, stack: &FittedStack) -> Result<Self, RestoreError> {
        let Snapshot { form, world, errand, record, speed_limit_mps, place, .. } = snapshot;
        if form != Snapshot::FORM {
            return Err(RestoreError::Form(form));
        }
        if let Some(speed_mps) = speed_limit_mps {
            ConfigError::unless_positive("speed_limit_mps", speed_mps)?;
        }
        if place.is_some_and(|place| !(place.point().is_finite() && place.theta.is_finite())) {
            return Err(RestoreError::Contradiction("place"));
        }
        let mut world = World::restored(world, stack)?;
        let errand = errand.map(|errand| revived(errand, &mut world, stack)).transpose()?;
        let StoredRecord { evaluation, guard, counts } = record;
        let guard = Guard::restored(stack.stop_rule.clone(), guard);
        Ok(Self {
            world,
            errand,
            record: Record { evaluation, asked: None, guard, counts, scratch: Scratch::default() },
            speed_limit_mps,
            slow: None,
            place,
            stepped: snapshot.stepped,
            unobserved: snapshot.unobserved,
            last: None,
            issued: snapshot.issued,
            parts: stack.clone(),
        })
    }
}

/// Restores the parts of an errand that are not stored.
fn revived(
    mut errand: Errand,
    world: &mut World,
    parts: &FittedStack,
) -> Result<Errand, RestoreError> {
    let Errand::Drive(task) = &mut errand else { return Ok(errand) };
    if task.passed >= task.stops.len() || task.asked.len() != task.stops.len() {
        return Err(RestoreError::Contradiction("errand"));
    }
    let stop = task.next_stop();
    if let (Mode::Waiting { why, .. }, Ok(told)) = (&mut task.mode, world.told()) {
        let budget = parts.stack.controller.replan_budget;
        if let Err(error) = world.router.again(told.pose.point(), stop, budget) {
            *why = error;
        }
    }
    Ok(errand)
}
