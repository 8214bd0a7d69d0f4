"""Private parts of the MuJoCo adapter: a scene as its model, its steps as samples; neither needs the library itself."""
