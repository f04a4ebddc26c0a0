"""Give it a body, a place to go, a ground and a way of walking; get a person who walks it."""
