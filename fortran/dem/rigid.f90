!> What steps without springs have in common, of blocks of the plane (dem_moreau) and of space (dem3_moreau): rigid
!> contacts that neither overlap nor pull, with Coulomb friction and Newton's restitution (Moreau 1988, Jean 1999:
!> "Moreau-Jean" time stepping).
!>
!> Velocities live at half steps, as in the steps with springs. From v(n-1/2) and the places x(n), the impulses of all
!> contacts in the step are found together (nonsmooth_impulses), such that no gap is negative at x(n+1):
!>
!>    g(x(n) + h v(n-1/2)) + h n.(v(n+1/2) - v(n-1/2)) >= 0,
!>
!> the gap at the place that the old velocity leads to, which includes the rotation of corners, and a linear step from
!> there. Motion that stays on its contacts is so followed to second order (the SHAKE of molecular dynamics: Ryckaert,
!> Ciccotti and Berendsen 1977); a contact that closes loses its parting velocity. With a rebound e a contact that
!> closes faster than gravity would in a few steps leaves with e times its speed instead. An overlap that is there
!> already is undone slowly.
!>
!> Mortar: a contact point that is bonded keeps its gap, with |S| <= c l + mu N and N >= -f_t l, and f_t at most c / mu. The impulses
!> are any within these limits, so that mortar holds as long as some forces in equilibrium do, as in limit analysis. Where a
!> bonded point moves at a limit, its mortar is lost for good.
!>
!> Reversals: where sliding stops within a step and starts again in the opposite direction, the impulses of the step hold the contact
!> at its end. Friction would have acted against the first direction for a share theta of the step, and against the second for the
!> rest: mu N h (1 - 2 theta) in sum. The difference acts in the next step, so that the slip is of second order, too.
!>
!> Quasi-static: every step starts from rest, so that nothing moves but what is moved or cannot stand, and time waits
!> until what moves has come to rest.
module dem_rigid
   use common_kinds, only : wp
   use common_status, only : status_ok, status_not_finite, status_out_of_memory
   use dem_clock, only : model_clock
   use dem_tape, only : tape
   use dem_joint, only : joint_law
   use nonsmooth_impulses, only : find_point_rate, impulse_effort, impulse_problem, problem_new, solve_impulses
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: rigid_solver, rigid_setting, set_rigid, forget_effort, walk_effort, suitable_step, number_bodies, &
      solve_step, parting, has_mortar, bear_mortar, gives_way, mortar_fails, find_reversal, wait_for_rest

   real(wp), parameter :: natural = 0.002_wp       !! of the time in which a block falls by its own size
   real(wp), parameter :: unhurried = 0.1_wp       !! the same without inertia
   real(wp), parameter :: tolerance = 1.0e-5_wp    !! of the velocity that gravity gives in a step
   integer, parameter :: most_rounds = 500
   real(wp), parameter :: at_rest = 1.0e-4_wp      !! of that velocity
   integer, parameter :: most_waits = 5000
   !> Of a normal impulse: no impact where it changes by less in a step
   real(wp), parameter, public :: steady = 0.5_wp
   real(wp), parameter :: recovery = 2.0_wp        !! steps of gravity: velocity at which overlaps are undone
   real(wp), parameter :: gentle = 5.0_wp          !! steps of gravity: slower contacts do not rebound
   real(wp), parameter :: least_gravity = 1.0e-3_wp   !! by which velocities are measured where there is less [m/s^2]

   !> Settings of rigid contacts
   type :: rigid_setting
      logical :: used = .false.                !! instead of the joints' springs and dashpots
      logical :: quasi_static = .false.        !! every step starts from rest
      real(wp) :: rebound = 0.0_wp             !! Newton's coefficient of restitution at each contact point
   end type rigid_setting

   type :: rigid_solver
      type(rigid_setting) :: setting
      real(wp) :: gravity = 0.0_wp             !! [m/s^2]
      real(wp) :: size = 0.0_wp                !! of the smallest block [m]
      real(wp) :: mass = 0.0_wp                !! of all [kg]
      integer :: pairs = -1                    !! for which the problem was made; -1: for none
      type(impulse_problem) :: problem
      integer, allocatable :: node(:)          !! (bodies) rank in the problem, 0 for supports
      integer :: steps = 0                     !! solved so far
      integer :: factors = 0                   !! factorisations they took
      integer :: most_rounds = 0               !! greatest number of rounds of one step
      integer :: open_steps = 0                !! steps that did not converge; on springs, of faces that crush
      real(wp) :: residual = 0.0_wp            !! greatest violation, over the velocity that gravity gives in a step
      real(wp) :: worst = 0.0_wp               !! time of the step in which it was [s]
      real(wp) :: error = 0.0_wp               !! greatest violation in the last step [m/s]
   end type rigid_solver

contains

   !> Before a run: settings of the contacts, and the scales of their velocities and energies
   pure subroutine set_rigid(solver, clock, setting, gravity, size, mass)
      class(rigid_solver), intent(inout) :: solver
      class(model_clock), intent(inout) :: clock
      type(rigid_setting), intent(in) :: setting
      real(wp), intent(in) :: gravity              !! [m/s^2]
      real(wp), intent(in) :: size                 !! of the smallest block [m]
      real(wp), intent(in) :: mass                 !! of all [kg]
      solver%setting = setting
      solver%gravity = max(gravity, least_gravity)
      solver%size = size
      solver%mass = mass
      clock%quasi_static = setting%used .and. setting%quasi_static
   end subroutine set_rigid

   !> What it took so far counts no more
   pure subroutine forget_effort(solver)
      class(rigid_solver), intent(inout) :: solver
      solver%steps = 0
      solver%factors = 0
      solver%most_rounds = 0
      solver%open_steps = 0
      solver%residual = 0.0_wp
      solver%worst = 0.0_wp
   end subroutine forget_effort

   !> What it took, on a walk through a state
   subroutine walk_effort(solver, on)
      class(rigid_solver), intent(inout), target :: solver
      type(tape), intent(inout) :: on
      call on%pass(solver%steps, storage_size(solver%steps))
      call on%pass(solver%factors, storage_size(solver%factors))
      call on%pass(solver%most_rounds, storage_size(solver%most_rounds))
      call on%pass(solver%open_steps, storage_size(solver%open_steps))
      call on%pass(solver%residual, storage_size(solver%residual))
      call on%pass(solver%worst, storage_size(solver%worst))
   end subroutine walk_effort

   !> A step that resolves the motion of the smallest block [s]
   pure function suitable_step(solver, quasi_static) result(step)
      class(rigid_solver), intent(in) :: solver
      logical, intent(in) :: quasi_static
      real(wp) :: step
      step = merge(unhurried, natural, quasi_static) * sqrt(solver%size / solver%gravity)
   end function suitable_step

   !> Order of the unknowns, after a search: ranks of the bodies, a problem without contact points
   subroutine number_bodies(solver, directions, fixed, bodies, status)
      class(rigid_solver), intent(inout) :: solver
      integer, intent(in) :: directions            !! see nonsmooth_impulses
      logical, intent(in) :: fixed(:)              !! (bodies) supports
      integer, intent(in) :: bodies(:, :)          !! (2, pairs) that are near each other
      integer(c_int), intent(out) :: status
      integer, allocatable :: link(:, :)
      integer :: k, nodes, links, failed

      status = status_out_of_memory
      if (.not. allocated(solver%node)) then
         allocate (solver%node(size(fixed)), stat=failed)
         if (failed /= 0) return
      end if
      allocate (link(2, size(bodies, 2)), stat=failed)
      if (failed /= 0) return
      nodes = 0
      do k = 1, size(fixed)
         solver%node(k) = 0
         if (fixed(k)) cycle
         nodes = nodes + 1
         solver%node(k) = nodes
      end do
      links = 0
      do k = 1, size(bodies, 2)
         if (any(solver%node(bodies(:, k)) == 0)) cycle
         links = links + 1
         link(:, links) = solver%node(bodies(:, k))
      end do
      call problem_new(nodes, directions, link(:, :links), solver%problem, status)
      if (status /= status_ok) return
      do k = 1, size(fixed)
         if (solver%node(k) > 0) solver%node(k) = solver%problem%matrix%rank(solver%node(k))
      end do
      solver%pairs = size(bodies, 2)
   end subroutine number_bodies

   !> Impulses of all contacts in a step, and what they took
   subroutine solve_step(solver, clock, status)
      class(rigid_solver), intent(inout) :: solver
      class(model_clock), intent(in) :: clock
      integer(c_int), intent(out) :: status         !! not_finite where a velocity is no number, else ok
      type(impulse_effort) :: effort
      real(wp) :: speed
      speed = clock%step * solver%gravity
      call solve_impulses(solver%problem, tolerance * speed, most_rounds, effort)
      status = merge(status_ok, status_not_finite, sum(abs(solver%problem%rate)) <= huge(speed))
      solver%steps = solver%steps + 1
      solver%factors = solver%factors + effort%factors
      solver%most_rounds = max(solver%most_rounds, effort%rounds)
      solver%error = effort%residual
      if (.not. effort%converged) solver%open_steps = solver%open_steps + 1
      if (effort%residual / speed > solver%residual) then
         solver%residual = effort%residual / speed
         solver%worst = clock%t
      end if
   end subroutine solve_step

   !> What is added to the parting velocity of a contact: what remains must not be negative [m/s]
   pure function parting(solver, step, gap, next_gap, u_n, bonded) result(shift)
      class(rigid_solver), intent(in) :: solver
      real(wp), intent(in) :: step                  !! [s]
      real(wp), intent(in) :: gap                   !! at the start of the step [m]
      real(wp), intent(in) :: next_gap              !! at the place that the old velocities lead to [m]
      real(wp), intent(in) :: u_n                   !! parting velocity of the last step [m/s]
      logical, intent(in) :: bonded                 !! mortar keeps the gap, even one above 0
      real(wp) :: shift
      real(wp) :: speed
      speed = step * solver%gravity
      if (bonded) then
         shift = (next_gap - max(gap, 0.0_wp)) / step - u_n
         if (gap < -recovery * speed * step) shift = shift - gap / step - recovery * speed
         return
      end if
      if (solver%setting%rebound > 0.0_wp .and. next_gap < 0.0_wp .and. u_n < -gentle * speed) then
         shift = solver%setting%rebound * u_n
         return
      end if
      shift = next_gap / step - u_n
      if (gap < -recovery * speed * step) shift = shift - gap / step - recovery * speed
   end function parting

   !> Whether a joint has mortar at all
   elemental function has_mortar(law) result(has)
      type(joint_law), intent(in) :: law
      logical :: has
      has = max(law%cohesion, law%tension) > 0.0_wp
   end function has_mortar

   !> Strength of the mortar at a contact point, as impulses of a step
   pure subroutine bear_mortar(solver, law, k, share)
      class(rigid_solver), intent(inout) :: solver
      type(joint_law), intent(in) :: law
      integer, intent(in) :: k                      !! point
      real(wp), intent(in) :: share                 !! length [m] or area [m^2] of the point times the step of velocities [s]
      associate (problem => solver%problem)
         problem%cohesion(k) = law%cohesion * share
         problem%tension(k) = law%tension * share
         if (law%friction * problem%tension(k) > problem%cohesion(k)) then
            problem%tension(k) = problem%cohesion(k) / law%friction
         end if
      end associate
   end subroutine bear_mortar

   !> Whether a point moves relative to where its mortar holds it
   pure function gives_way(solver, clock, k) result(moves)
      class(rigid_solver), intent(in) :: solver
      class(model_clock), intent(in) :: clock
      integer, intent(in) :: k
      logical :: moves
      moves = norm2(find_point_rate(solver%problem, k)) > at_rest * clock%step * solver%gravity
   end function gives_way

   !> Whether the mortar at a point fails: the point moves by more than the error of the step
   pure function mortar_fails(solver, clock, k) result(fails)
      class(rigid_solver), intent(in) :: solver
      class(model_clock), intent(in) :: clock
      integer, intent(in) :: k                      !! point
      logical :: fails
      fails = gives_way(solver, clock, k)
      if (fails) fails = norm2(find_point_rate(solver%problem, k)) > solver%error
   end function mortar_fails

   !> Whether sliding stops within a step and starts again in the opposite direction, from the speeds in the last two steps and from
   !> the friction that holds the contact. Over the weight of the step the load is rho, with old = theta (1 + rho) and
   !> held = rho - theta (1 + rho) of the friction; it starts again where rho > 1
   pure subroutine find_reversal(older, old, held, bound, reverses, share)
      real(wp), intent(in) :: older                 !! speed in the step before the last [m/s]
      real(wp), intent(in) :: old                   !! speed in the last step [m/s]
      real(wp), intent(in) :: held                  !! impulse along that motion that holds the contact [N s]
      real(wp), intent(in) :: bound                 !! greatest friction impulse [N s]
      logical, intent(out) :: reverses
      real(wp), intent(out) :: share                !! friction impulse of the step along that motion, over its bound: 1 - 2 theta
      real(wp) :: fall, brake
      share = 0.0_wp
      fall = older - old
      reverses = old > 0.0_wp .and. fall >= old .and. bound > 0.0_wp .and. held > -bound
      if (.not. reverses) return
      brake = (fall - old) / (1.0_wp + held / bound)
      reverses = fall - brake > brake
      share = 1.0_wp - 2.0_wp * old / fall
   end subroutine find_reversal

   !> Without inertia time stands still until all has come to rest, or fallen
   pure subroutine wait_for_rest(solver, clock, speed)
      class(rigid_solver), intent(in) :: solver
      class(model_clock), intent(inout) :: clock
      real(wp), intent(in) :: speed                 !! greatest of any body [m/s]
      logical :: moves
      moves = speed > at_rest * clock%step * solver%gravity
      clock%waits = merge(clock%waits + 1, 0, clock%shaking .and. moves .and. clock%waits < most_waits)
   end subroutine wait_for_rest

end module dem_rigid
