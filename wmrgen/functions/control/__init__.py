"""Control laws of the texts, and the limits that are kept between kinematics and motors."""
