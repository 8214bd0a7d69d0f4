"""From one outcome to a probability: many draws of what a scene does not know, by the model and by contact engines."""
