"""Pictures and animations of marks, drawings and programs."""
