//! Service servers.

use super::{Delivery, Wire, fault};
use crate::error::StartError;
use crate::messages::Service;
use ros2_client::{Message, Server, ServiceMapping, ServiceTypeName};

/// A service whose messages can be sent.
pub(crate) trait WiredService: Service<Request: Message, Response: Message> {}

impl<S> WiredService for S where S: Service<Request: Message, Response: Message> {}

/// A server of a service.
pub(crate) struct ServiceServer<S: WiredService> {
    server: Server<S::Request, S::Response>,
}

impl Wire {
    /// Creates a server of a service.
    pub(crate) fn service<S: WiredService>(
        &mut self,
        name: &str,
    ) -> Result<ServiceServer<S>, StartError> {
        let (package, service) = S::NAME;
        let type_name = ServiceTypeName::new(package, service);
        let (full, qos) = (self.name(name)?, Delivery::Reliable.qos(10));
        let mut server = self
            .node
            .create_server(ServiceMapping::Enhanced, &full, &type_name, qos.clone(), qos)
            .map_err(|error| fault(format_args!("serve {name}"), error))?;
        self.register(&mut server)?;
        Ok(ServiceServer { server })
    }
}

impl<S: WiredService> ServiceServer<S> {
    /// Answers all requests since the last call.
    pub(crate) fn answer_requests(&mut self, mut answer: impl FnMut(S::Request) -> S::Response) {
        while let Ok(Some((id, request))) = self.server.receive_request() {
            drop(self.server.send_response(id, answer(request)));
        }
    }
}
