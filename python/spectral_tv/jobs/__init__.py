"""Jobs of the package, several polled like one."""
