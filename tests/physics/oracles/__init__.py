"""What the physics tests measure with: small scenes, a ray caster and an edge fit of their own."""
