"""What a status page shows, its server, and the renderer that replays share with it."""
