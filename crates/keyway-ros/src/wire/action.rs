//! Action servers: goals that are requested, cancelled, and finished.

use super::{Delivery, Wire, fault};
use crate::error::StartError;
use crate::messages::Action;
use crate::messages::builtin_interfaces::Time;
use ros2_client::action::{
    ActionServerQosPolicies, CancelGoalRequest, CancelGoalResponse, GetResultResponse, GoalInfo,
    GoalStatusEnum, SendGoalResponse,
};
use ros2_client::action_msgs::{
    CancelGoalResponseEnum, GoalStatus as StatusMessage, GoalStatusArray,
};
use ros2_client::{
    ActionTypeName, Message, RmwRequestId, ServiceMapping, action, builtin_interfaces,
};
use serde::Deserialize;
use std::collections::VecDeque;

/// Id of a goal, given by its client.
pub(crate) type GoalId = action::GoalId;

/// The final status of a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GoalStatus {
    Succeeded,
    Canceled,
    Aborted,
}

/// A request of a client.
#[derive(Clone, Debug)]
pub(crate) enum GoalEvent<G> {
    /// An accepted goal.
    Begin(GoalId, G),
    /// An accepted cancellation of a goal.
    Cancel(GoalId),
}

/// An action whose messages can be sent.
pub(crate) trait Wired:
    Action<Goal: Message, Outcome: Message + Default, Feedback: Message>
{
}

impl<A> Wired for A where A: Action<Goal: Message, Outcome: Message + Default, Feedback: Message> {}

/// A server of an action.
pub(crate) struct ActionServer<A: Wired> {
    server: ros2_client::ActionServer<A::Goal, A::Outcome, A::Feedback>,
    /// Accepted goals, the oldest first.
    goals: VecDeque<GoalRecord<A::Outcome>>,
}

/// An accepted goal.
struct GoalRecord<R> {
    info: GoalInfo,
    status: GoalStatusEnum,
    outcome: Option<R>,
    /// Pending requests for the outcome.
    asked: Vec<RmwRequestId>,
}

/// Request of `action_msgs/srv/CancelGoal`, whose fields are private.
#[derive(Deserialize)]
struct CancelRequest {
    id: [u8; 16],
    stamp: Time,
}

impl CancelRequest {
    fn of(request: &CancelGoalRequest) -> Option<Self> {
        let bytes = cdr_encoding::to_vec::<_, byteorder::LittleEndian>(request).ok()?;
        Some(cdr_encoding::from_bytes::<_, byteorder::LittleEndian>(&bytes).ok()?.0)
    }

    /// True for the requested goals: one by its id, and those accepted until a time; without
    /// both, all goals.
    fn means(&self, info: &GoalInfo) -> bool {
        let (any_id, any_time) = (self.id == [0; 16], self.stamp == Time::default());
        let is_it = !any_id && *info.goal_id.uuid.as_bytes() == self.id;
        let until = builtin_interfaces::Time::new(self.stamp.sec, self.stamp.nanosec);
        is_it || (!any_time && info.stamp.to_nanos() <= until.to_nanos()) || (any_id && any_time)
    }
}

impl Wire {
    /// Creates a server of an action.
    pub(crate) fn action<A: Wired>(&mut self, name: &str) -> Result<ActionServer<A>, StartError> {
        let service = Delivery::Reliable.qos(10);
        let qos = ActionServerQosPolicies {
            goal_service: service.clone(),
            result_service: service.clone(),
            cancel_service: service.clone(),
            feedback_publisher: service,
            status_publisher: Delivery::Latched.qos(1),
        };
        let (package, action) = A::NAME;
        let type_name = ActionTypeName::new(package, action);
        let name = self.name(name)?;
        let mut server = self
            .node
            .create_action_server(ServiceMapping::Enhanced, &name, &type_name, qos)
            .map_err(|error| fault(format_args!("serve the action {name}"), error))?;
        self.register(server.goal_server())?;
        self.register(server.cancel_server())?;
        self.register(server.result_server())?;
        Ok(ActionServer { server, goals: VecDeque::new() })
    }
}

impl<A: Wired> ActionServer<A> {
    /// Number of outcomes kept for late requests.
    const KEPT: usize = 32;

    /// All requests since the last call.
    pub(crate) fn events(&mut self, now: Time) -> Vec<GoalEvent<A::Goal>> {
        let mut events = Vec::new();
        while let Ok(Some((request, asked))) = self.server.receive_goal() {
            // Ids are unique.
            let accepted = !self.goals.iter().any(|goal| goal.info.goal_id == asked.goal_id);
            let stamp = builtin_interfaces::Time::new(now.sec, now.nanosec);
            if accepted {
                let info = GoalInfo { goal_id: asked.goal_id, stamp };
                let status = GoalStatusEnum::Executing;
                self.goals.push_back(GoalRecord { info, status, outcome: None, asked: Vec::new() });
                events.push(GoalEvent::Begin(asked.goal_id, asked.goal));
            }
            drop(self.server.send_goal_response(request, SendGoalResponse { accepted, stamp }));
        }
        while let Ok(Some((request, asked))) = self.server.receive_cancel_request() {
            let (response, canceled) = self.cancel(&asked);
            events.extend(canceled.into_iter().map(GoalEvent::Cancel));
            drop(self.server.send_cancel_response(request, response));
        }
        while let Ok(Some((request, asked))) = self.server.receive_result_request() {
            match self.goals.iter_mut().find(|goal| goal.info.goal_id == asked.goal_id) {
                Some(GoalRecord { status, outcome: Some(result), .. }) => {
                    let response = GetResultResponse { status: *status, result: result.clone() };
                    drop(self.server.send_result(request, response));
                }
                Some(goal) => goal.asked.push(request),
                None => {
                    let (status, result) = (GoalStatusEnum::Unknown, A::Outcome::default());
                    drop(self.server.send_result(request, GetResultResponse { status, result }));
                }
            }
        }
        if !events.is_empty() {
            self.publish_statuses();
        }
        events
    }

    /// Refuses all goals since the last call.
    pub(crate) fn refuse_all(&mut self) {
        while let Ok(Some((request, _))) = self.server.receive_goal() {
            let (accepted, stamp) = (false, builtin_interfaces::Time::new(0, 0));
            drop(self.server.send_goal_response(request, SendGoalResponse { accepted, stamp }));
        }
    }

    /// The goals that a request cancels, and the response to it.
    fn cancel(&mut self, request: &CancelGoalRequest) -> (CancelGoalResponse, Vec<GoalId>) {
        let refused = |return_code| {
            (CancelGoalResponse { return_code, goals_canceling: Vec::new() }, Vec::new())
        };
        let Some(request) = CancelRequest::of(request) else {
            return refused(CancelGoalResponseEnum::Rejected);
        };
        let meant = || self.goals.iter().filter(|goal| request.means(&goal.info));
        let is_meant = meant().next().is_some();
        let mut given_up = Vec::new();
        for goal in self.goals.iter_mut().filter(|goal| request.means(&goal.info)) {
            if goal.outcome.is_none() {
                goal.status = GoalStatusEnum::Canceling;
                given_up.push(goal.info.clone());
            }
        }
        if given_up.is_empty() {
            let is_one = request.id != [0; 16];
            return refused(match (is_one, is_meant) {
                (true, true) => CancelGoalResponseEnum::GoalTerminated,
                (true, false) => CancelGoalResponseEnum::UnknownGoal,
                (false, _) => CancelGoalResponseEnum::Rejected,
            });
        }
        let ids = given_up.iter().map(|info| info.goal_id).collect();
        let return_code = CancelGoalResponseEnum::None;
        (CancelGoalResponse { return_code, goals_canceling: given_up }, ids)
    }

    /// Finishes a goal.
    pub(crate) fn finish(&mut self, id: GoalId, status: GoalStatus, outcome: A::Outcome) {
        let Some(goal) = self.goals.iter_mut().find(|goal| goal.info.goal_id == id) else { return };
        goal.status = match status {
            GoalStatus::Succeeded => GoalStatusEnum::Succeeded,
            GoalStatus::Canceled => GoalStatusEnum::Canceled,
            GoalStatus::Aborted => GoalStatusEnum::Aborted,
        };
        for request in goal.asked.drain(..) {
            let response = GetResultResponse { status: goal.status, result: outcome.clone() };
            drop(self.server.send_result(request, response));
        }
        goal.outcome = Some(outcome);
        self.publish_statuses();
        while self.goals.len() > Self::KEPT && self.goals[0].outcome.is_some() {
            self.goals.pop_front();
        }
    }

    /// Sends feedback to the client of a goal.
    pub(crate) fn publish_feedback(&self, id: GoalId, feedback: A::Feedback) {
        drop(self.server.send_feedback(id, feedback));
    }

    fn publish_statuses(&self) {
        let status = |goal: &GoalRecord<_>| StatusMessage {
            goal_info: goal.info.clone(),
            status: goal.status,
        };
        let status_list = self.goals.iter().map(status).collect();
        drop(self.server.send_goal_statuses(GoalStatusArray { status_list }));
    }
}
