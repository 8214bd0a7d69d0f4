"""The nouns: what is run, what is asked, what is answered, what a user did wrong."""
