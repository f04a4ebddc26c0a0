"""Where the feet go and when: footsteps, and plans made of them. Plans know no walks."""
