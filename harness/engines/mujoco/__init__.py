"""Parts of the MuJoCo engine that know MuJoCo's conventions, but not its library."""
