pub(crate) fn run(_: &crate::args::ListArgs) -> Result<super::Done, crate::error::CliError> { todo!() }
