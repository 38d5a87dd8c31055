"""What a page may ask of its session, by purpose: each answer takes the desk and a message, and gives replies."""
