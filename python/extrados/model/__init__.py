"""What a building is: tables, stones, geometry. Nothing here knows the views that strategies take."""
