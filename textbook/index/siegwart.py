"""Siegwart, Nourbakhsh, Scaramuzza, section 2.3 and chapter 3."""

from __future__ import annotations

from textbook.index.records import LIBRARY, Row

TEXT = "Siegwart"
DEGREES = "degree_of_mobility,degree_of_steerability,degree_of_maneuverability=degrees"
TWIST = "vx,vy,omega=twist_body"


def row(places: str, says: str, robot: str, command: str, inputs: str, outputs: str, case: str = "") -> Row:
    """Return a row of this text; see `Row`."""
    return Row(TEXT, places, says, robot, command, inputs, outputs, case)


def formula(places: str, says: str, function: str, inputs: str, outputs: str, case: str = "") -> Row:
    """Return a row for a function of the textbook library; see `Row`."""
    return row(places, says, LIBRARY, f"eval {function}", inputs, outputs, case)


def degrees(places: str, says: str, robot: str, case: str) -> Row:
    """Return a row for mobility, steerability and maneuverability of a robot; see `Row`."""
    return row(places, says, robot, "derive -o build", "", DEGREES, case)


def in_table(number: int, wheels: int, says: str, robot: str, case: str) -> Row:
    """Return a row of table 2.1.

    Args:
        number: the row among those with as many wheels.
        wheels: the number of wheels.
        says: what the row describes.
        robot: the robot file under ``robots/texts/``.
        case: the case with its degrees.

    Returns:
        The row.
    """
    return degrees(f"Table 2.1 ({wheels} wheels, {number})", says, f"texts/{robot}", case)


def stable(says: str, case: str) -> Row:
    """Return a row for the conditions on the gains of the polar law; see `Row`."""
    outputs = "stable=stable strong_3_65=strong_3_65 strong_all_beta=strong_all_beta"
    return row("(3.60)-(3.65)", says, "", "gains", "k_rho,k_alpha,k_beta=k", outputs, case)


WHEELS = (
    formula("(3.2), 3.2.1", "rotation from world to robot coordinates", "rotation_world_to_robot", "theta=theta",
            "m=R", "S-3.2"),
    formula("(3.10)", "rotation from robot to world coordinates", "rotation_robot_to_world", "theta=theta", "m=R_inv",
            "S-3.2"),
    formula("(3.2)-(3.5)", "a velocity of the world in the robot frame, at theta = pi/2", "world_to_robot",
            "theta=theta x_rate,y_rate,theta_rate=rate_world", "vx,vy,omega=rate_robot", "S-3.5"),
    formula("(3.10)", "a twist of the robot in the world frame", "robot_to_world",
            "theta=theta vx,vy,omega=rate_robot", "x_rate,y_rate,theta_rate=rate_world", "S-3.5"),
    formula("(3.7), (3.8)", "turning rate from each wheel of a differential drive", "wheel_contributions",
            "r=r l=l right.spin=phidot1 left.spin=phidot2", "right.omega=omega1 left.omega=omega2", "S-3.7"),
    row("(3.6), (3.9)-(3.11)", "worked example: r = l = 1, theta = pi/2, wheel speeds 4 and 2",
        "texts/siegwart_differential", "eval forward_world",
        "theta=pi/2 right.spin=wheel_rates.right left.spin=wheel_rates.left",
        "x_rate,y_rate,theta_rate=twist_world", "S-3.11"),
    row("(3.12)", "rolling row of a fixed wheel", "texts/siegwart_wheel_fixed", "derive --json", "",
        "J1=value J2=J2", "S-3.12"),
    row("(3.13)", "sliding row of a fixed wheel", "texts/siegwart_wheel_fixed", "derive --json", "", "C1f=value",
        "S-3.13"),
    row("(3.14)", "velocity across a wheel at alpha = beta = 0: it is vx, whatever vy and omega are (corrected)",
        "texts/konstantinov", "eval projections", "vx=0.7 vy=-0.3 omega=0.4", "w1.across=0.7"),
    row("(3.15), (3.16)", "first entries of both rows of a steered wheel, at beta = -0.6",
        "texts/siegwart_wheel_steered", "eval projections", "vx=1 w.steer=-1.05", "w.along=J1.0.0 w.across=C1.0.0",
        "S-3.15"),
    row("(3.15), (3.16)", "last entries of both rows of a steered wheel, at beta = -0.6",
        "texts/siegwart_wheel_steered", "eval projections", "omega=1 w.steer=-1.05",
        "w.along=J1.0.2 w.across=C1.0.2", "S-3.15"),
    row("(3.17)", "first entry of the rolling row of a castor", "texts/siegwart_wheel_castor", "eval projections",
        "vx=1", "w.along=J1.0.0", "S-3.17"),
    row("(3.17)", "last entry of the rolling row of a castor", "texts/siegwart_wheel_castor", "eval projections",
        "omega=1", "w.along=J1.0.2", "S-3.17"),
    formula("(3.18)", "where a towed castor comes to rest", "castor_alignment",
            "alpha=alpha d=d r=wheel.r vx,vy=V", "beta_stable=equilibria_beta.stable "
            "beta_unstable=equilibria_beta.unstable rate=linear_rate_stable spin=phi_dot_at_stable",
            "S-castor-align"),
    formula("(3.18)", "angle of a towed castor after 0.15 s", "castor_swivel",
            "beta=beta0 alpha=alpha d=d vx=twist_body.0 vy=twist_body.1 t=t", "beta=beta", "S-castor-traj"),
    row("(3.17), (3.18)", "speeds of four driven castors", "texts/siegwart_nomad_xr4000", "eval inverse",
        f"{TWIST} front_left.steer=0 front_right.steer=0.3 rear_left.steer=0.6 rear_right.steer=0.9",
        "front_left.spin,front_right.spin,rear_left.spin,rear_right.spin=phi_dot "
        "front_left.steer_rate,front_right.steer_rate,rear_left.steer_rate,rear_right.steer_rate=beta_dot",
        "S-xr4000-ik"),
    row("(3.17), (3.18)", "twist from the speeds of four driven castors", "texts/siegwart_nomad_xr4000",
        "eval forward",
        "front_left.spin,front_right.spin,rear_left.spin,rear_right.spin=phi_dot "
        "front_left.steer_rate,front_right.steer_rate,rear_left.steer_rate,rear_right.steer_rate=beta_dot "
        "front_left.steer=0 front_right.steer=0.3 rear_left.steer=0.6 rear_right.steer=0.9",
        "vx,vy,omega=twist_body", "S-xr4000-fk"),
    degrees("Figure 3.7", "an office chair on five castors moves in every direction", "office_chair", "S-chair"),
    row("(3.19)", "rolling row of a Swedish wheel", "texts/siegwart_wheel_swedish", "derive --json", "",
        "J1=value J2=J2", "S-3.19"),
    row("(3.19), (3.20)", "wheel and roller rate of a Swedish wheel ((3.20) corrected)",
        "texts/siegwart_wheel_swedish", "eval contacts", TWIST, "w.roller=phi_sw_dot", "S-3.20"),
    formula("(3.19), (3.20)", "wheel and roller rate of a Swedish wheel ((3.20) corrected)", "swedish_wheel",
            "vx,vy,omega=twist_body l=wheel.l alpha=wheel.alpha beta=wheel.beta gamma=wheel.gamma r=wheel.r "
            "r_sw=wheel.r_sw", "spin=phi_dot roller=phi_sw_dot", "S-3.20"),
    row("(3.21), (3.22)", "direction and rate at which a ball rolls", "texts/siegwart_wheel_ball", "eval contacts",
        TWIST, "w.direction=heading_of_roll w.roll=phi_dot", "S-3.21"),
)  # fmt: skip

ROBOTS = (
    row("(3.23)-(3.29)", "rolling and sliding rows of a differential drive", "textbook_differential",
        "derive --json", "", "J1/0=value.0 J1/1=value.1 C1f/0=value.2", "S-3.29"),
    row("(3.24)-(3.28)", "the same constraints solved for all rates", "texts/siegwart_differential",
        "eval configuration", "theta=pi/2 right.spin=4 left.spin=2",
        "x_rate=0 y_rate=3 theta_rate=1 right.spin=4 left.spin=2"),
    row("(3.24), (3.26)", "pose from the angles of the wheels", "texts/siegwart_differential",
        "eval odometry_from_angles", "theta=pi/2 right.spin_step=1 left.spin_step=1",
        "x=0 y=1 theta=1.5707963267948966"),
    row("(3.2)", "turning about the left wheel", "texts/siegwart_differential", "eval inverse_about",
        "omega=1 centre_y=1", "right.spin=2 left.spin=0"),
    row("(3.30)", "the inverse of (3.29), by its columns: wheel speeds 1 and 0", "textbook_differential",
        "eval forward", "right.spin=1 left.spin=0", "vx=0.05 vy=0 omega=0.08333333333333333"),
    row("(3.31), (3.32)", "rolling rows of three Swedish wheels", "textbook_omnidirectional", "derive --json", "",
        "J1=value", "S-3.32"),
    row("(3.33)", "world velocity of three Swedish wheels", "textbook_omnidirectional", "eval forward_world",
        "theta=phi w1.spin,w2.spin,w3.spin=wheel_rates", "x_rate,y_rate,theta_rate=twist_world", "S-3.33-world"),
    row("(3.34)", "worked example: l = r = 1, theta = 0, wheel speeds 4, 1 and 2", "texts/siegwart_three_omni",
        "eval forward_world", "w1.spin=4 w2.spin=1 w3.spin=2",
        "x_rate=1.1547005383792515 y_rate=-1.3333333333333333 theta_rate=-2.3333333333333335"),
    degrees("(3.35)-(3.37), (3.40)", "a single fixed wheel", "texts/siegwart_wheel_fixed", "S-unicycle"),
    row("(3.38)", "both sliding rows of a differential drive are one constraint", "texts/siegwart_differential",
        "derive --json", "", "rank_C1f=rank_C1f degree_of_mobility=degrees.0", "S-T2.1-2b"),
    row("(3.39)", "the locked bicycle keeps one motion", "locked_bicycle", "derive --json", "",
        "rank_C1f=rank_C1f degree_of_mobility=degrees.0 dof=dof", "S-lockbike"),
    degrees("(3.40)-(3.42)", "a car: one steerability, though two wheels steer", "texts/siegwart_car_rear_drive",
            "S-T2.1-4a"),
    row("(3.43), 3.4.2", "DDOF 2 and DOF 3: the differential drive is nonholonomic", "texts/siegwart_differential",
        "structure", "", "holonomic=holonomic ddof=ddof dof=dof", "S-T2.1-2b"),
    row("3.4.2, (3.39)", "DDOF 1 and DOF 1: the locked bicycle is holonomic", "locked_bicycle", "structure", "",
        "holonomic=holonomic ddof=ddof dof=dof", "S-lockbike"),
    row("(3.44), 3.4.2", "the locked bicycle: a wheel's angle is x/r", "locked_bicycle", "eval wheel_angles", "x=0.75",
        "front.angle=7.5 rear.angle=7.5"),
    degrees("3.3.1", "a bicycle locked at an angle", "texts/siegwart_bent_bicycle", "S-lockbike-bent"),
    degrees("3.3.1", "three fixed wheels whose axles do not meet cannot move", "texts/siegwart_three_fixed",
            "S-rank3"),
    row("3.3.3, 2.3.2.1", "the synchro drive translates and never turns", "texts/siegwart_synchro",
        "eval forward_world", "theta=phi w1.steer=steer w2.steer=steer w3.steer=steer "
        "w1.spin=phi_dot_common w2.spin=phi_dot_common w3.spin=phi_dot_common",
        "x_rate,y_rate,theta_rate=twist_world", "S-synchro-fk"),
    degrees("3.3.3", "synchro drive", "texts/siegwart_synchro", "S-T2.1-3f"),
    degrees("2.3.2.4", "Shrimp, on a plane without slip", "texts/siegwart_shrimp", "S-shrimp"),
    row("2.3.2.2", "mecanum wheels with diagonals opposite: sideways", "texts/tzafestas_mecanum", "eval forward",
        "w1.spin,w2.spin,w3.spin,w4.spin=wheel_rates", "vx,vy,omega=twist_body", "S-2.3.2.2-diag"),
    degrees("Figure 3.14 (omnidirectional)", "three Swedish wheels", "textbook_omnidirectional", "S-F3.14-omni"),
    degrees("Figure 3.14 (differential)", "two fixed wheels and a ball", "textbook_differential", "S-F3.14-diff"),
    degrees("Figure 3.14 (omni-steer)", "a steered wheel and two balls", "textbook_omni_steer", "S-F3.14-omnisteer"),
    degrees("Figure 3.14 (tricycle), Figure 3.13", "two fixed wheels and a steered one", "textbook_tricycle",
            "S-F3.14-tricycle"),
    degrees("Figure 3.14 (two-steer)", "two steered wheels and a ball", "textbook_two_steer", "S-F3.14-twosteer"),
    row("Figure 3.15", "first leg: 1 m/s along x", "textbook_omnidirectional", "eval inverse_world",
        "x_rate,y_rate,theta_rate=segments.0.twist_world", "w1.spin,w2.spin,w3.spin=wheel_rates.0", "S-F3.15"),
    row("Figure 3.15", "second leg: a quarter turn in one second", "textbook_omnidirectional", "eval inverse_world",
        "x_rate,y_rate,theta_rate=segments.1.twist_world", "w1.spin,w2.spin,w3.spin=wheel_rates.1", "S-F3.15"),
    row("Figure 3.15", "third leg: 1 m/s along y, at theta = pi/2", "textbook_omnidirectional", "eval inverse_world",
        "theta=pi/2 x_rate,y_rate,theta_rate=segments.2.twist_world", "w1.spin,w2.spin,w3.spin=wheel_rates.2",
        "S-F3.15"),
    row("Figure 3.15", "the twist that reaches the end of the first leg in one second", "textbook_omnidirectional",
        "eval reach", "x=1 dt=1", "vx=1 vy=0 omega=0"),
    row("Figure 3.16", "turning on the spot: the wheels steer to -50 and 50 degrees", "texts/siegwart_two_steer",
        "eval inverse", "omega=1", "w1.steer=-0.8726646259971648 w2.steer=0.8726646259971648 w1.spin=5 w2.spin=-5"),
)  # fmt: skip

TABLE = (
    in_table(1, 2, "bicycle", "siegwart_bicycle", "S-T2.1-2a"),
    in_table(2, 2, "two-wheel differential drive (Cye)", "siegwart_cye", "S-T2.1-2b"),
    in_table(1, 3, "centred differential drive, third contact (Nomad Scout)", "siegwart_nomad_scout", "S-T2.1-3a"),
    in_table(2, 3, "differential drive, unpowered wheel (Pygmalion, Alice)", "siegwart_pygmalion", "S-T2.1-3b"),
    in_table(3, 3, "two connected traction wheels, steered free wheel (Piaggio)", "siegwart_piaggio", "S-T2.1-3c"),
    in_table(4, 3, "two free wheels, steered traction wheel (Neptune, Hero-1)", "siegwart_neptune", "S-T2.1-3d"),
    in_table(5, 3, "three Swedish or spherical wheels (Tribolo)", "siegwart_tribolo", "S-T2.1-3e"),
    in_table(6, 3, "synchro drive", "siegwart_synchro", "S-T2.1-3f"),
    in_table(1, 4, "car with rear drive", "siegwart_car_rear_drive", "S-T2.1-4a"),
    in_table(2, 4, "car with front drive", "siegwart_car_front_drive", "S-T2.1-4b"),
    in_table(3, 4, "four steered and motorized wheels (Hyperion)", "siegwart_hyperion", "S-T2.1-4c"),
    in_table(4, 4, "two traction wheels, two omnidirectional wheels (Charlie)", "siegwart_charlie", "S-T2.1-4d"),
    in_table(5, 4, "four Swedish-45 wheels (Uranus)", "siegwart_uranus", "S-T2.1-4e"),
    in_table(6, 4, "differential drive, two more contacts (Khepera)", "siegwart_khepera", "S-T2.1-4f"),
    in_table(7, 4, "four driven castors (Nomad XR4000)", "siegwart_nomad_xr4000", "S-T2.1-4g"),
    in_table(1, 6, "two steered wheels, four omnidirectional wheels (First)", "siegwart_first", "S-T2.1-6a"),
    in_table(2, 6, "differential drive, four omnidirectional wheels (Terregator)", "siegwart_terregator",
             "S-T2.1-6b"),
)  # fmt: skip

CONTROL = (
    formula("(3.48)", "the unicycle", "unicycle", "theta=state.phi v=input.v omega=input.omega",
            "x_rate,y_rate,theta_rate=rate", "A-unicycle"),
    formula("(3.50)-(3.52)", "polar coordinates of the goal", "polar_coordinates", "x=-0.7 y=0.4 theta=0.3",
            "rho,alpha,beta=state", "S-3.53"),
    formula("(3.50)-(3.52)", "the pose from polar coordinates", "polar_pose", "rho,alpha,beta=state",
            "x=-0.7 y=0.4 theta=0.3", "S-3.53"),
    formula("(3.53)", "rates of the polar coordinates, forward", "polar_rates",
            "rho,alpha,beta=state v=input.v omega=input.omega", "rho_rate,alpha_rate,beta_rate=rate", "S-3.53"),
    formula("(3.55)", "rates of the polar coordinates, backwards (corrected)", "polar_rates_reverse",
            "rho,alpha,beta=state v=input.v_reversed omega=input.omega", "rho_rate,alpha_rate,beta_rate=rate",
            "S-3.55"),
    formula("(3.56)-(3.58)", "closed loop of the polar law", "polar_closed_loop",
            "rho,alpha,beta=[1,0.5,-0.25] k_rho=3 k_alpha=8 k_beta=-1.5",
            "rho_rate=-2.6327476856711183 alpha_rate=-2.936723384187391 beta_rate=-1.438276615812609 v=3 omega=4.375"),
    formula("(3.59)-(3.62)", "linearised closed loop at the gains of (3.59)", "polar_linearisation",
            "k_rho=3 k_alpha=8 k_beta=-1.5", "a11=-3 a22=-5 a23=1.5 a32=-3"),
    formula("(3.63)", "the characteristic polynomial at the gains of (3.59)", "polar_linearisation",
            "k_rho=3 k_alpha=8 k_beta=-1.5", "p2=8 p1=19.5 p0=13.5"),
    formula("(3.61)-(3.65)", "the margin of each condition, above 0 if it holds", "polar_gains",
            "k_rho=0.5 k_alpha=10.5 k_beta=-6",
            "stable=0.5 strong_3_65=0.18169011381620934 strong_all_beta=-1.8183098861837907"),
    stable("k_alpha below k_rho: not stable", "S-3.60-a"),
    stable("k_beta above 0: not stable", "S-3.60-b"),
    stable("k_rho below 0: not stable", "S-3.60-c"),
    stable("stable, and (3.65) holds, but not for every start ((3.65) corrected)", "S-3.60-e"),
    row("(3.56)-(3.58)", "the polar law for a robot 1 m behind its goal", "texts/siegwart_differential",
        "eval goto_pose", "x=-1", "v=3 omega=0 rho=1 alpha=0 beta=0 right.spin=3 left.spin=3"),
    formula("Figure 3.20", "closed loop at the start (-1, 0, 0) of the figure", "polar_closed_loop",
            "rho,alpha,beta=state0 k_rho,k_alpha,k_beta=k", "rho_rate=-3 alpha_rate=0 beta_rate=0 v=3 omega=0",
            "S-F3.20-3"),
)  # fmt: skip

PROBLEMS = (
    degrees("Problem 2.5.2", "an omnidirectional design: two driven castors and a ball",
            "texts/siegwart_problem_2_5_2", "S-2.5.2-a"),
    row("Problem 3.7.1", "wheels of unequal diameters 2 and 3, both at 6 rad/s",
        "texts/siegwart_problem_3_7_1", "eval forward_world", "theta=pi/4 right.spin=6 left.spin=6",
        "x_rate=5.303300858899106 y_rate=5.303300858899106 theta_rate=0.3"),
    row("Problem 3.7.2", "two balls, each driven about two axes: only one turns, about its first axis",
        "texts/siegwart_problem_3_7_2", "eval forward", "b1_1.spin=1", "vx=value.0.0 vy=value.1.0 omega=value.2.0",
        "S-3.7.2"),
    degrees("Problem 3.7.3(b)", "a robot balanced on one ball", "texts/siegwart_ball", "S-3.7.3b"),
    row("Problem 3.7.4", "wheel speeds of three Swedish wheels, l = 10 and r = 1", "texts/siegwart_problem_3_7_4",
        "eval inverse", TWIST, "w1.spin,w2.spin,w3.spin=wheel_rates", "S-3.7.4"),
)  # fmt: skip

ROWS: tuple[Row, ...] = (*WHEELS, *ROBOTS, *TABLE, *CONTROL, *PROBLEMS)
