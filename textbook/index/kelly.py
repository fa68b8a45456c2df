"""Kelly, slides to chapter 4."""

from __future__ import annotations

from textbook.index.records import LIBRARY, Row

TEXT = "Kelly"
TWIST = "vx,vy,omega=twist_body"


def row(places: str, says: str, robot: str, command: str, inputs: str, outputs: str, case: str = "") -> Row:
    """Return a row of this text; see `Row`."""
    return Row(TEXT, places, says, robot, command, inputs, outputs, case)


def formula(places: str, says: str, function: str, inputs: str, outputs: str, case: str = "") -> Row:
    """Return a row for a function of the textbook library; see `Row`."""
    return row(places, says, LIBRARY, f"eval {function}", inputs, outputs, case)


SPACE = (
    formula("4.1.2.1, 4.1.2.2", "position for an observer in uniform motion", "galilean",
            "r=[1,2,3] r_start=[0.5,0,0] v=[1,0,-1] t=2", "r=[3.5,2,1]"),
    formula("4.1.2.3", "rate of a vector for a fixed observer", "transport_theorem", "u_rate=du_dt_m omega=omega u=u",
            "rate=du_dt_f", "KE-transport"),
    formula("4.1.2.4, (4.23)", "velocity in a moving frame (corrected)", "moving_frame_velocity",
            "v_m=v_m omega=omega r=r v_o=v_o_m", "v=v_o_f", "KE-vel"),
    formula("4.1.2.5", "acceleration in a moving frame", "moving_frame_acceleration",
            "a_m=a_m alpha=alpha omega=omega r=r v_o=v_o_m a_o=a_o_m",
            "a=a_o_f euler=euler centripetal=centripetal coriolis=coriolis", "KE-acc"),
    formula("4.1.3", "specific force at the centre of gravity", "specific_force",
            "t=t_sensor alpha=alpha omega=omega r=r_cg v=v_cg a=a_cg", "t=t_cg", "KE-specific-force"),
    row("4.1.3", "specific force at the centre of gravity, turning at 1 rad/s", "texts/kelly_tipping",
        "eval cg_force", "fy=2 fz=9 sensor.x=1 wz=1", "fx=1 fy=2 fz=9"),
    row("4.1.3", "margin before tipping, at 4 m/s^2 to the left", "texts/kelly_tipping", "stability",
        "fy=a_lateral fz=g", "margin=margin_angle liftoff=liftoff", "KE-liftoff"),
    formula("4.1.4.1", "the matrix of a cross product", "skew_matrix", "u=[1,2,3]",
            "m=[[0,-3,2],[3,0,-1],[-2,1,0]]"),
    formula("(4.24)", "H(r)", "h_matrix", "r=r", "h=H", "KE-4.25"),
    formula("(4.25)", "Omega(omega) (corrected)", "omega_matrix", "omega=omega", "o=Omega", "KE-4.25"),
    formula("(4.26), (4.27)", "velocity through two frames", "two_step_velocity",
            "r_1=r_c_v r_2=r_c_s v_1=v_v omega_1=omega_v v_2=v_s_v omega_2=omega_s v_o=v_c_s", "v=v_c", "KE-4.30"),
    formula("(4.28), (4.29)", "acceleration through two frames that both turn at 1 rad/s about z",
            "two_step_acceleration",
            "r_1=[2,0,0] r_2=[1,0,0] a_1=[0,0,0] alpha_1=[0,0,0] omega_1=[0,0,1] v_2=[0,0,0] a_2=[0,0,0] "
            "alpha_2=[0,0,0] omega_2=[0,0,1] v_o=[0,0,0] a_o=[0,0,0]", "a=[-5,0,0]"),
    formula("(4.30)", "velocity of the contact of an articulated wheel", "articulated_wheel_velocity",
            "r_vehicle=r_c_v r_steer=r_c_s v_vehicle=v_v omega_vehicle=omega_v v_steer=v_s_v "
            "omega_steer=omega_s v_o=v_c_s", "v=v_c", "KE-4.30"),
    formula("(4.31)", "acceleration of the contact of an articulated wheel", "articulated_wheel_acceleration",
            "r_vehicle=r_c_v r_steer=r_c_s a_vehicle=a_v alpha_vehicle=alpha_v omega_vehicle=omega_v "
            "v_steer=[0,0,0.05] a_steer=a_s_v alpha_steer=alpha_s omega_steer=omega_s v_o=v_c_s a_o=a_c_s",
            "a=a_c v_seen=v_c_v", "KE-4.31"),
    formula("(4.40)", "velocity of a contact in space", "wheel_velocity", "v=v_v omega=omega_v r=r_c", "v=v_c",
            "KE-3d"),
    formula("(4.39)", "velocity of the contact of an offset steered wheel", "offset_wheel_velocity",
            "v=[1,0,0] omega=[0,0,1] r=[1,0.5,0] r_steer=[0,0.1,0] omega_steer=[0,0,2]", "v=[0.3,1,0]"),
)  # fmt: skip

PLANE = (
    row("4.2.1.1", "centre of rotation of a twist", "texts/kelly_differential", "icr",
        "vx=0.75 vy=-0.7 omega=omega", "icr=icr", "KE-ICR"),
    row("4.2.1.1", "velocity of a point", "texts/kelly_differential", "eval icr",
        "vx=0.75 vy=-0.7 omega=omega point.x,point.y=q", "point.vx,point.vy=v_q", "KE-ICR"),
    row("4.2.1.2", "axles that meet in one point", "texts/kelly_generalized_bicycle", "eval axles",
        "w1.steer,w2.steer=gamma", "radius=1.7677669529663687 mismatch=0", "KE-genbike-ik"),
    row("4.2.1.2, Ackermann", "steering angle for a centre of rotation at the radius R", "texts/kelly_ackermann",
        "eval steer_to", "icr.y=R icr.w=1", "front.steer=gamma", "KE-ack-inv"),
    row("4.2.1.2", "crab steering: all wheels in one direction", "kelly_4ws", "eval inverse",
        "vx=v_body.0 vy=v_body.1", "w1.steer,w2.steer,w3.steer,w4.steer=steer", "KE-jeantaud-crab"),
    formula("4.2.1.3", "velocity of a rolling disk", "rolling_disk", "r=0.5 spin=2 phi=pi/6",
            "x_rate=0.8660254037844387 y_rate=0.5"),
    formula("4.2.1.4", "a rolling disk does not slide (corrected)", "disk_constraint",
            "phi=pi/6 x_rate=0.8660254037844387 y_rate=0.5", "w1=0.5 w2=-0.8660254037844387 slide=0"),
    row("4.2.2.1.2, (4.39)", "velocity of the contact of an offset wheel", "texts/kelly_steered_wheel",
        "eval contact_velocity", f"{TWIST} w.steer=gamma w.steer_rate=gamma_dot", "w.vx,w.vy=v_c", "KE-speed"),
    row("(4.30)", "the same from the motion in space", "texts/kelly_steered_wheel", "eval wheel_motion",
        "vx=twist_body.0 vy=twist_body.1 wz=twist_body.2 w.steer=gamma w.steer_rate=gamma_dot", "w.vx,w.vy=v_c",
        "KE-speed"),
    row("(4.31)", "in the plane: wheel speeds and their rates at 2 m/s and 1 m/s^2", "texts/kelly_differential",
        "eval accelerations", "vx=2 vx_rate=1", "right.spin=2 left.spin=2 right.spin_rate=1 left.spin_rate=1"),
    row("4.2.2.1.1", "steering angle of a wheel", "texts/kelly_steered_wheel", "eval inverse", TWIST,
        "w.steer=gamma", "KE-steer"),
    formula("4.2.2.2.1", "velocity that a steered wheel senses", "steer_sense",
            "r=r spin=omega_wheel steer=gamma", "v=v vx,vy=v_xy", "KE-sense"),
    row("differential steer", "wheel speeds", "texts/kelly_differential", "eval inverse", TWIST,
        "right.spin=wheel_linear_speeds.right left.spin=wheel_linear_speeds.left", "KE-dd-inv"),
    row("differential steer", "speeds of the vehicle", "texts/kelly_differential", "eval forward",
        "right.spin=wheel_linear_speeds.right left.spin=wheel_linear_speeds.left", "vx=v_x omega=omega",
        "KE-dd-fwd"),
    row("Ackermann", "steering angle and radius", "texts/kelly_ackermann", "eval inverse", "vx=v_x omega=omega",
        "front.steer=gamma", "KE-ack-inv"),
    row("Ackermann", "radius and curvature", "texts/kelly_ackermann", "icr", "vx=v_x omega=omega",
        "radius=R curvature=kappa", "KE-ack-inv"),
    row("Ackermann", "speeds of the vehicle", "texts/kelly_ackermann", "eval forward",
        "front.spin=9.656603957913982 front.steer=0.37089128881266237", "vx=v_x omega=omega", "KE-ack-fwd"),
    row("generalized bicycle", "steering angles and contact velocities", "texts/kelly_generalized_bicycle",
        "eval inverse", TWIST, "w1.steer,w2.steer=gamma", "KE-genbike-ik"),
    row("generalized bicycle", "velocities of both contacts", "texts/kelly_generalized_bicycle",
        "eval contact_velocity", TWIST, "w1.vx,w1.vy,w2.vx,w2.vy=v_c", "KE-genbike-ik"),
    row("Box 4.2", "least squares: the first column of the pseudo-inverse of H", "texts/kelly_generalized_bicycle",
        "eval forward", "w1.spin=10", "vx=pinv.0.0 vy=pinv.1.0 omega=pinv.2.0", "KE-genbike-H"),
    row("(4.62), 4 wheel steer", "contact velocities with offsets", "kelly_4ws", "eval contact_velocity",
        f"{TWIST} w1.steer,w2.steer,w3.steer,w4.steer=gamma "
        "w1.steer_rate,w2.steer_rate,w3.steer_rate,w4.steer_rate=gamma_dot",
        "w1.vx,w1.vy,w2.vx,w2.vy,w3.vx,w3.vy,w4.vx,w4.vy=v_c", "KE-4ws-vc"),
    row("4 wheel steer", "steering angles and wheel speeds with offsets", "kelly_4ws", "eval inverse", TWIST,
        "w1.steer,w2.steer,w3.steer,w4.steer=gamma", "KE-4ws-ik"),
)  # fmt: skip

ROWS: tuple[Row, ...] = (*SPACE, *PLANE)
