!> Two blocks, one upon the other, that rock without sliding or flight: two coordinates and their modes.
!>
!> q1 and q2 are the rotations of the lower and of the upper block, clockwise (to +x). Each of the two contacts is shut,
!> or open about its right (+1) or left (-1) edge: both open in the same sense or against each other, the upper block
!> alone, or both as one body are the four modes of Psycharis 1990. Here no transition is a rule of its own: which
!> contacts open at rest, while others rock, or after an impact follows from one condition, that at each edge of a
!> shut contact either a force (an impulse) presses or the edge parts. The solution is unique because the kinetic
!> energy is positive; after an impact it is Moreau's, without rebound, so that energy never grows.
module rocking_stack
   use common_cancel, only : cancel_requested
   use common_kinds, only : wp, gravity, pi
   use common_lists, only : event_collapse => rocking_event_collapse, event_impact => rocking_event_impact, &
      event_rest => rocking_event_rest, event_uplift => rocking_event_uplift, &
      outcome_collapse => rocking_outcome_collapse, outcome_no_hinging => rocking_outcome_no_hinging, &
      outcome_recovery => rocking_outcome_recovery
   use common_signal, only : signal
   use common_status, only : status_ok, status_cancelled, status_invalid_argument, status_step_too_small, &
      status_too_many_steps
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: stack, stack_new, stack_history, stack_rock, stack_parameters, stack_rows, stack_impact

   !> Numbers of a stack: mass [kg], inertia [kg m^2], height of the centre above its foot [m] of the lower and of the
   !> upper block; half width of the lower foot, height of the lower block, half width of the contact between [m]
   integer, parameter :: stack_parameters = 9
   !> Rows of a history: q1, q2 [rad], their rates, ground to +x and up [m/s^2], kinetic and potential energy, work of
   !> the ground less loss at impacts [J], states of both contacts (0 shut, +1, -1), force of the ground on the lower
   !> and of the lower on the upper block, each x and y [N]
   integer, parameter :: stack_rows = 15
   integer, parameter :: poll_every = 500
   integer, parameter :: max_steps = 20000000

   type :: stack
      real(wp) :: mass(2) = 0.0_wp
      real(wp) :: inertia(2) = 0.0_wp
      real(wp) :: centre(2) = 0.0_wp  !! height above the foot of each
      real(wp) :: half(2) = 0.0_wp    !! half width of the contacts: on the ground, between the blocks
      real(wp) :: height = 0.0_wp     !! of the lower block
      real(wp) :: limit(2) = 0.0_wp   !! |q1| and |q2 - q1| taken as collapse [rad]
      real(wp) :: rest_rate(2) = 0.0_wp  !! of q1 and q2 - q1 after an impact, below which a contact stays shut [rad/s]
   end type stack

   !> In the caller's arrays
   type :: stack_history
      integer :: points = 0
      real(wp), pointer, contiguous :: time(:) => null()      !! asked for, ascending [s]
      real(wp), pointer, contiguous :: state(:, :) => null()  !! (stack_rows, points)
      integer :: events = 0
      integer(c_int), pointer, contiguous :: event_kind(:) => null()
      real(wp), pointer, contiguous :: event(:, :) => null()  !! (2, room): time [s], contact: 1 ground, 2 between
      integer(c_int) :: outcome = outcome_no_hinging
      integer(c_int) :: impacts(2) = 0   !! at each contact
      integer(c_int) :: steps = 0
      logical :: settled = .false.
      real(wp) :: work = 0.0_wp, loss = 0.0_wp
      real(wp) :: peak(2) = 0.0_wp       !! of q1 and q2, with sign
      real(wp) :: stop_time = 0.0_wp
   end type stack_history

   !> Equation of motion in a pair of pivots: matrix (accelerations of q1, q2) = right
   type :: pivot_equation
      real(wp) :: matrix(2, 2) = 0.0_wp
      real(wp) :: right(2) = 0.0_wp
   end type pivot_equation

   real(wp), parameter :: c2 = 1.0_wp / 5.0_wp, c3 = 3.0_wp / 10.0_wp, c4 = 4.0_wp / 5.0_wp, c5 = 8.0_wp / 9.0_wp

contains

   !> Set up from the flat parameter list
   subroutine stack_new(parameters, made, status)
      real(wp), intent(in) :: parameters(:)  !! see stack_parameters
      type(stack), intent(out) :: made
      integer(c_int), intent(out) :: status
      real(wp) :: radius
      integer :: i

      status = status_invalid_argument
      if (size(parameters) /= stack_parameters) return
      if (any(parameters <= 0.0_wp) .or. parameters(8) <= parameters(3)) return
      made%mass = parameters([1, 4])
      made%inertia = parameters([2, 5])
      made%centre = parameters([3, 6])
      made%half = parameters([7, 9])
      made%height = parameters(8)
      do i = 1, 2
         made%limit(i) = min(2.0_wp * atan2(made%half(i), made%centre(i)), 0.5_wp * pi)
         ! a millionth of the energy that overturns the block alone
         radius = hypot(made%half(i), made%centre(i))
         made%rest_rate(i) = 1.0e-3_wp * sqrt(2.0_wp * made%mass(i) * gravity * (radius - made%centre(i)) &
            / (made%inertia(i) + made%mass(i) * radius**2))
      end do
      status = status_ok
   end subroutine stack_new

   !> From the pivot of the ground to the centre of the lower block and to the pivot between, and from there to the
   !> centre of the upper block, at rest
   pure subroutine arms(body, s, d1, e, d2)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)  !! pivots; 0 the middle
      real(wp), intent(out) :: d1(2)  !! to the centre of the lower block [m]
      real(wp), intent(out) :: e(2)   !! to the pivot between [m]
      real(wp), intent(out) :: d2(2)  !! from there to the centre of the upper block [m]
      d1 = [-s(1) * body%half(1), body%centre(1)]
      e = [s(2) * body%half(2) - s(1) * body%half(1), body%height]
      d2 = [-s(2) * body%half(2), body%centre(2)]
   end subroutine arms

   !> A vector turned clockwise
   pure function turned(v, q) result(w)
      real(wp), intent(in) :: v(2)
      real(wp), intent(in) :: q  !! [rad]
      real(wp) :: w(2)
      w = [v(1) * cos(q) + v(2) * sin(q), -v(1) * sin(q) + v(2) * cos(q)]
   end function turned

   !> Kinetic matrix about a pair of pivots, and K' of its coupling
   pure subroutine kinetic_matrix(body, s, q, matrix, slope)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)            !! pivots
      real(wp), intent(in) :: q(2)           !! rotations [rad]
      real(wp), intent(out) :: matrix(2, 2)  !! [kg m^2]
      real(wp), intent(out) :: slope         !! of the coupling by q2 - q1 [kg m^2]
      real(wp) :: d1(2), e(2), d2(2), along, across, r
      call arms(body, s, d1, e, d2)
      r = q(2) - q(1)
      along = dot_product(e, d2)
      across = e(1) * d2(2) - e(2) * d2(1)
      matrix(1, 1) = body%inertia(1) + body%mass(1) * dot_product(d1, d1) + body%mass(2) * dot_product(e, e)
      matrix(2, 2) = body%inertia(2) + body%mass(2) * dot_product(d2, d2)
      matrix(1, 2) = body%mass(2) * (along * cos(r) + across * sin(r))
      matrix(2, 1) = matrix(1, 2)
      slope = body%mass(2) * (across * cos(r) - along * sin(r))
   end subroutine kinetic_matrix

   !> The equation of motion about a pair of pivots
   pure function motion_about(body, s, q, v, ground) result(one)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)        !! pivots
      real(wp), intent(in) :: q(2)       !! rotations [rad]
      real(wp), intent(in) :: v(2)       !! rates [rad/s]
      real(wp), intent(in) :: ground(2)  !! acceleration to +x and up [m/s^2]
      type(pivot_equation) :: one
      real(wp) :: d1(2), e(2), d2(2), slope, first(2), second(2)
      call arms(body, s, d1, e, d2)
      call kinetic_matrix(body, s, q, one%matrix, slope)
      first = body%mass(1) * turned(d1, q(1)) + body%mass(2) * turned(e, q(1))
      second = body%mass(2) * turned(d2, q(2))
      one%right(1) = (gravity + ground(2)) * first(1) - ground(1) * first(2) - slope * v(2)**2
      one%right(2) = (gravity + ground(2)) * second(1) - ground(1) * second(2) + slope * v(1)**2
   end function motion_about

   !> The balance of momentum about a pair of pivots, of blocks that moved about others before
   pure function momentum_about(body, s, q, before, v) result(one)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)       !! after
      real(wp), intent(in) :: q(2)
      integer, intent(in) :: before(2)  !! pivots before
      real(wp), intent(in) :: v(2)      !! rates before
      type(pivot_equation) :: one
      real(wp) :: d1(2), e(2), d2(2), b1(2), be(2), b2(2), x1(2), x2(2), slope
      call arms(body, before, b1, be, b2)
      call arms(body, s, d1, e, d2)
      call kinetic_matrix(body, s, q, one%matrix, slope)
      x1 = v(1) * across(turned(b1, q(1)))
      x2 = v(1) * across(turned(be, q(1))) + v(2) * across(turned(b2, q(2)))
      one%right(1) = body%inertia(1) * v(1) + body%mass(1) * dot_product(x1, across(turned(d1, q(1)))) &
         + body%mass(2) * dot_product(x2, across(turned(e, q(1))))
      one%right(2) = body%inertia(2) * v(2) + body%mass(2) * dot_product(x2, across(turned(d2, q(2))))

   contains

      !> Change of a vector that turns clockwise
      pure function across(w) result(u)
         real(wp), intent(in) :: w(2)
         real(wp) :: u(2)
         u = [w(2), -w(1)]
      end function across

   end function momentum_about

   !> Rates (or accelerations) of q1 and q2 about a pair of pivots, contacts of pivot 0 shut
   pure function solved(one, s) result(x)
      type(pivot_equation), intent(in) :: one
      integer, intent(in) :: s(2)
      real(wp) :: x(2)
      real(wp) :: determinant
      if (s(1) == 0 .and. s(2) == 0) then
         x = 0.0_wp
      else if (s(1) == 0) then
         x = [0.0_wp, one%right(2) / one%matrix(2, 2)]
      else if (s(2) == 0) then
         x = sum(one%right) / sum(one%matrix)
      else
         determinant = one%matrix(1, 1) * one%matrix(2, 2) - one%matrix(1, 2)**2
         x = [one%matrix(2, 2) * one%right(1) - one%matrix(1, 2) * one%right(2), &
            one%matrix(1, 1) * one%right(2) - one%matrix(1, 2) * one%right(1)] / determinant
      end if
   end function solved

   !> Least pressing force of the edges of each shut contact, as its moment about the other edge [N m]; a large number
   !> where one is not shut. Of impulses, with momenta before instead of the motion [N m s].
   pure function pressing(body, s, q, v, x, ground, before) result(least)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)
      real(wp), intent(in) :: q(2), v(2)  !! of momenta: rates before
      real(wp), intent(in) :: x(2)        !! accelerations, or rates after
      real(wp), intent(in) :: ground(2)
      integer, intent(in), optional :: before(2)  !! pivots before an impact
      real(wp) :: least(2)                !! of the ground, of the contact between
      type(pivot_equation) :: one
      integer :: i, side, trial(2)
      real(wp) :: excess(2)
      least = huge(1.0_wp)
      do i = 1, 2
         if (s(i) /= 0) cycle
         do side = -1, 1, 2
            trial = s
            trial(i) = side
            if (present(before)) then
               one = momentum_about(body, trial, q, before, v)
            else
               one = motion_about(body, trial, q, v, ground)
            end if
            excess = matmul(one%matrix, x) - one%right
            ! the upper block turns with the lower where the contact between is shut
            if (i == 1 .and. s(2) == 0) excess(1) = sum(excess)
            ! the moment about this edge is that of the force of the other
            least(i) = min(least(i), real(side, wp) * excess(i))
         end do
      end do
   end function pressing

   !> The pivots about which contacts that touch go on, by accelerations, or by rates after an impact
   pure subroutine choose(body, touching, s, q, v, ground, x, before)
      type(stack), intent(in) :: body
      logical, intent(in) :: touching(2)  !! else the pivot is given
      integer, intent(inout) :: s(2)      !! pivots
      real(wp), intent(in) :: q(2), v(2)
      real(wp), intent(in) :: ground(2)
      real(wp), intent(out) :: x(2)       !! accelerations, or rates after
      integer, intent(in), optional :: before(2)  !! pivots before an impact
      real(wp) :: y(2), wrong, best, least(2), apart(2), scale(2)
      integer :: one, two, trial(2), found(2)
      integer, parameter :: order(3) = [0, 1, -1]

      best = huge(1.0_wp)
      found = s
      x = 0.0_wp
      ! moments over those of the weights, rotations over the angular unit g/height
      scale = gravity * [sum(body%mass) * body%half(1), body%mass(2) * body%half(2)]
      do one = 1, merge(3, 1, touching(1))
         do two = 1, merge(3, 1, touching(2))
            trial = s
            if (touching(1)) trial(1) = order(one)
            if (touching(2)) trial(2) = order(two)
            if (present(before)) then
               y = solved(momentum_about(body, trial, q, before, v), trial)
               least = pressing(body, trial, q, v, y, ground, before)
            else
               y = solved(motion_about(body, trial, q, v, ground), trial)
               least = pressing(body, trial, q, v, y, ground)
            end if
            apart = real(trial, wp) * [y(1), y(2) - y(1)]
            wrong = max(0.0_wp, maxval(-least / scale))
            if (touching(1) .and. trial(1) /= 0) wrong = max(wrong, -apart(1) * body%height / gravity)
            if (touching(2) .and. trial(2) /= 0) wrong = max(wrong, -apart(2) * body%height / gravity)
            if (wrong < best - 1.0e-12_wp) then
               best = wrong
               found = trial
               x = y
            end if
         end do
      end do
      s = found
   end subroutine choose

   !> Rates after an impact at a contact, for tests and for the run
   pure subroutine stack_impact(body, s, q, v, at, s_after, v_after)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)         !! pivots before
      real(wp), intent(in) :: q(2), v(2)
      logical, intent(in) :: at(2)        !! contacts that close
      integer, intent(out) :: s_after(2)
      real(wp), intent(out) :: v_after(2)
      s_after = s
      call choose(body, at .or. s == 0, s_after, q, v, [0.0_wp, 0.0_wp], v_after, s)
   end subroutine stack_impact

   !> Kinetic and potential energy [J]
   pure function energies(body, s, q, v) result(energy)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)
      real(wp), intent(in) :: q(2), v(2)
      real(wp) :: energy(2)
      real(wp) :: matrix(2, 2), slope, d1(2), e(2), d2(2), rise(2), w(2)
      call kinetic_matrix(body, s, q, matrix, slope)
      call arms(body, s, d1, e, d2)
      w = turned(d1, q(1))
      rise(1) = w(2) - d1(2)
      w = turned(e, q(1)) + turned(d2, q(2))
      rise(2) = w(2) - e(2) - d2(2)
      energy = [0.5_wp * dot_product(v, matmul(matrix, v)), gravity * dot_product(body%mass, rise)]
   end function energies

   !> Forces of the ground on the lower and of the lower on the upper block, x and y [N]
   pure function contact_forces(body, s, q, v, a, ground) result(force)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)
      real(wp), intent(in) :: q(2), v(2), a(2)
      real(wp), intent(in) :: ground(2)
      real(wp) :: force(4)
      real(wp) :: d1(2), e(2), d2(2), x1(2), x2(2)
      call arms(body, s, d1, e, d2)
      x1 = bent(d1, 1)
      x2 = bent(e, 1) + bent(d2, 2)
      force(3:4) = body%mass(2) * (x2 + ground + [0.0_wp, gravity])
      force(1:2) = force(3:4) + body%mass(1) * (x1 + ground + [0.0_wp, gravity])

   contains

      !> Acceleration of the end of an arm that turns with block k
      pure function bent(arm, k) result(u)
         real(wp), intent(in) :: arm(2)
         integer, intent(in) :: k
         real(wp) :: u(2)
         real(wp) :: w(2)
         w = turned(arm, q(k))
         u = a(k) * [w(2), -w(1)] - v(k)**2 * w
      end function bent

   end function contact_forces

   !> Power of the ground [W]
   pure function power(body, s, q, v, ground) result(p)
      type(stack), intent(in) :: body
      integer, intent(in) :: s(2)
      real(wp), intent(in) :: q(2), v(2)
      real(wp), intent(in) :: ground(2)
      real(wp) :: p
      real(wp) :: d1(2), e(2), d2(2), w(2), u(2)
      call arms(body, s, d1, e, d2)
      w = turned(body%mass(1) * d1 + body%mass(2) * e, q(1))
      u = turned(body%mass(2) * d2, q(2))
      p = -ground(1) * (v(1) * w(2) + v(2) * u(2)) + ground(2) * (v(1) * w(1) + v(2) * u(1))
   end function power

   !> Rock the stack from a state until the end time or collapse
   subroutine stack_rock(body, motion, start, end_time, tolerance, record, status)
      type(stack), intent(in) :: body
      type(signal), intent(in) :: motion
      real(wp), intent(in) :: start(4)    !! q1, q2 [rad], rates [rad/s]; at rest where zero
      real(wp), intent(in) :: end_time    !! [s]
      real(wp), intent(in) :: tolerance   !! relative, per step
      type(stack_history), intent(inout) :: record
      integer(c_int), intent(out) :: status
      real(wp) :: t, y(5), fresh(5), h, h_next, error, t_next, hit, low, high, middle, ground(2), x(2), before(2)
      real(wp) :: atol(5), scale(2), r
      integer :: s(2), segment, attempts, i, new_s(2)
      logical :: at(2), quiet, opens, moved, touching(2)

      status = status_ok
      t = 0.0_wp
      y = [start, 0.0_wp]  ! rotations, rates, work of the ground
      s = 0
      if (abs(y(1)) > 0.0_wp .or. abs(y(3)) > 0.0_wp) s(1) = nint(sign(1.0_wp, merge(y(1), y(3), abs(y(1)) > 0.0_wp)))
      r = merge(y(2) - y(1), y(4) - y(3), abs(y(2) - y(1)) > 0.0_wp)
      if (abs(r) > 0.0_wp) s(2) = nint(sign(1.0_wp, r))
      moved = any(s /= 0)
      scale = gravity * [sum(body%mass) * body%half(1), body%mass(2) * body%half(2)]
      atol(1:2) = 0.01_wp * tolerance * maxval(body%limit)
      atol(3:4) = 10.0_wp * tolerance * maxval(body%rest_rate)
      atol(5) = tolerance * sum(body%mass) * gravity * body%half(1) * maxval(body%limit)
      segment = 0
      do while (segment <= motion%segments)
         if (motion%break_time(segment + 1) > t) exit
         segment = segment + 1
      end do
      h_next = 1.0e-3_wp
      attempts = 0
      call reopen()
      do while (t < end_time)
         attempts = attempts + 1
         if (attempts > max_steps) status = status_too_many_steps
         if (mod(attempts, poll_every) == 0) then
            if (cancel_requested()) status = status_cancelled
         end if
         if (status /= status_ok) exit
         call write_out()
         quiet = segment > motion%segments
         t_next = end_time
         if (.not. quiet) t_next = min(t_next, motion%break_time(segment + 1))
         if (record%points < size(record%time)) t_next = min(t_next, max(record%time(record%points + 1), t))
         if (quiet .and. all(s == 0)) then
            t = t_next
            if (record%points >= size(record%time)) t = end_time
            cycle
         end if
         h = min(h_next, 0.05_wp, 0.125_wp * motion%shortest_period(segment))
         if (h >= t_next - t) then
            h = t_next - t
         else if (h > 0.5_wp * (t_next - t)) then
            h = 0.5_wp * (t_next - t)
         end if
         if (h <= 4.0_wp * spacing(t)) then
            t = t_next
            call next_segment()
            cycle
         end if
         call step(h, fresh, error)
         if (.not. error <= 1.0_wp) then
            h_next = h * merge(max(0.1_wp, 0.9_wp * error**(-0.2_wp)), 0.1_wp, error <= huge(error))
            if (h_next <= 8.0_wp * spacing(max(t, 1.0e-3_wp))) status = status_step_too_small
            cycle
         end if
         h_next = max(h_next, h) * min(5.0_wp, max(0.2_wp, 0.9_wp * max(error, 1.0e-10_wp)**(-0.2_wp)))
         if (h_next > 4.0_wp * h) h_next = max(4.0_wp * h, 1.0e-4_wp)
         record%steps = record%steps + 1

         hit = passed(fresh, h)
         if (hit <= 0.0_wp) then
            low = 0.0_wp
            high = h
            do i = 1, 60
               middle = 0.5_wp * (low + high)
               if (high - low <= 4.0_wp * spacing(t + h)) exit
               call step(middle, fresh, error)
               if (passed(fresh, middle) <= 0.0_wp) then
                  high = middle
               else
                  low = middle
               end if
            end do
            h = high
            call step(h, fresh, error)
         end if
         t = merge(t_next, t + h, h >= t_next - t)
         y = fresh
         call note_peaks()
         if (any(abs([y(1), y(2) - y(1)]) >= body%limit)) then
            call note(event_collapse, merge(1, 2, abs(y(1)) >= body%limit(1)))
            record%outcome = outcome_collapse
            exit
         end if
         if (hit <= 0.0_wp) then
            at = closes(y)
            opens = .not. any(at)
            if (opens) then
               call reopen()
            else
               call strike()
            end if
         end if
         call next_segment()
      end do
      record%work = y(5)
      record%stop_time = t
      call write_out()
      if (record%outcome /= outcome_collapse) then
         if (moved) record%outcome = outcome_recovery
         record%settled = segment > motion%segments .and. all(s == 0) .and. status == status_ok
      else
         record%settled = .true.
      end if

   contains

      !> To the next segment of the ground motion where its break is reached; a jump may open contacts
      subroutine next_segment()
         if (segment > motion%segments) return
         if (t < motion%break_time(segment + 1)) return
         segment = segment + 1
         call reopen()
      end subroutine next_segment

      !> Rates of the state
      function slope_of(time, state) result(rate)
         real(wp), intent(in) :: time
         real(wp), intent(in) :: state(5)
         real(wp) :: rate(5)
         real(wp) :: shaking(2)
         call motion%value_at(segment, time, shaking(1), shaking(2))
         rate(1:2) = state(3:4)
         rate(3:4) = solved(motion_about(body, s, state(1:2), state(3:4), shaking), s)
         rate(5) = power(body, s, state(1:2), state(3:4), shaking)
      end function slope_of

      !> One step of Dormand and Prince from the present state
      subroutine step(length, reached, misfit)
         real(wp), intent(in) :: length
         real(wp), intent(out) :: reached(5)
         real(wp), intent(out) :: misfit  !! over the tolerance
         real(wp) :: k1(5), k2(5), k3(5), k4(5), k5(5), k6(5), k7(5), off(5)
         k1 = slope_of(t, y)
         k2 = slope_of(t + c2 * length, y + length * c2 * k1)
         k3 = slope_of(t + c3 * length, y + length * (3.0_wp / 40.0_wp * k1 + 9.0_wp / 40.0_wp * k2))
         k4 = slope_of(t + c4 * length, y + length * (44.0_wp / 45.0_wp * k1 - 56.0_wp / 15.0_wp * k2 &
            + 32.0_wp / 9.0_wp * k3))
         k5 = slope_of(t + c5 * length, y + length * (19372.0_wp / 6561.0_wp * k1 - 25360.0_wp / 2187.0_wp * k2 &
            + 64448.0_wp / 6561.0_wp * k3 - 212.0_wp / 729.0_wp * k4))
         k6 = slope_of(t + length, y + length * (9017.0_wp / 3168.0_wp * k1 - 355.0_wp / 33.0_wp * k2 &
            + 46732.0_wp / 5247.0_wp * k3 + 49.0_wp / 176.0_wp * k4 - 5103.0_wp / 18656.0_wp * k5))
         reached = y + length * (35.0_wp / 384.0_wp * k1 + 500.0_wp / 1113.0_wp * k3 + 125.0_wp / 192.0_wp * k4 &
            - 2187.0_wp / 6784.0_wp * k5 + 11.0_wp / 84.0_wp * k6)
         k7 = slope_of(t + length, reached)
         off = length * (71.0_wp / 57600.0_wp * k1 - 71.0_wp / 16695.0_wp * k3 + 71.0_wp / 1920.0_wp * k4 &
            - 17253.0_wp / 339200.0_wp * k5 + 22.0_wp / 525.0_wp * k6 - 1.0_wp / 40.0_wp * k7)
         misfit = sqrt(sum((off / (atol + tolerance * max(abs(y), abs(reached))))**2) / 5.0_wp)
         if (s(1) == 0) reached([1, 3]) = 0.0_wp
         if (s(2) == 0) reached([2, 4]) = reached([1, 3])
      end subroutine step

      !> Above zero while open contacts are open and shut ones press, at a state reached after a length
      function passed(state, length) result(margin)
         real(wp), intent(in) :: state(5)
         real(wp), intent(in) :: length
         real(wp) :: margin
         real(wp) :: shaking(2), push(2), q(2), v(2)
         q = state(1:2)
         v = state(3:4)
         margin = 1.0_wp
         if (s(1) /= 0 .and. real(s(1), wp) * v(1) < 0.0_wp) margin = min(margin, real(s(1), wp) * q(1))
         if (s(2) /= 0 .and. real(s(2), wp) * (v(2) - v(1)) < 0.0_wp) then
            margin = min(margin, real(s(2), wp) * (q(2) - q(1)))
         end if
         if (any(s == 0)) then
            call motion%value_at(segment, t + length, shaking(1), shaking(2))
            push = pressing(body, s, q, v, solved(motion_about(body, s, q, v, shaking), s), shaking)
            ! an edge that presses with nothing has not parted yet
            margin = min(margin, minval(push / scale) + 1.0e-12_wp)
         end if
      end function passed

      !> Which open contacts close at a state
      function closes(state) result(answer)
         real(wp), intent(in) :: state(5)
         logical :: answer(2)
         answer(1) = s(1) /= 0 .and. real(s(1), wp) * state(1) <= 0.0_wp .and. real(s(1), wp) * state(3) < 0.0_wp
         answer(2) = s(2) /= 0 .and. real(s(2), wp) * (state(2) - state(1)) <= 0.0_wp &
            .and. real(s(2), wp) * (state(4) - state(3)) < 0.0_wp
      end function closes

      !> An impact where contacts close
      subroutine strike()
         real(wp) :: energy(2), gone(2)
         integer :: contact
         do contact = 1, 2
            if (.not. at(contact)) cycle
            record%impacts(contact) = record%impacts(contact) + 1
            call note(event_impact, contact)
         end do
         if (at(1)) then
            y(2) = y(2) - merge(y(1), 0.0_wp, s(2) == 0)
            y(1) = 0.0_wp
         end if
         if (at(2) .or. s(2) == 0) y(2) = y(1)
         energy = energies(body, s, y(1:2), y(3:4))
         touching = at .or. s == 0
         call stack_impact(body, s, y(1:2), y(3:4), at, new_s, before)
         ! contacts that hardly part stay shut
         if (touching(1) .and. abs(before(1)) <= body%rest_rate(1)) then
            before(1) = 0.0_wp
            new_s(1) = 0
         end if
         if (touching(2) .and. real(new_s(2), wp) * (before(2) - before(1)) <= body%rest_rate(2)) new_s(2) = 0
         if (new_s(2) == 0) before(2) = before(1)
         s = new_s
         y(3:4) = before
         gone = energies(body, s, y(1:2), y(3:4))
         record%loss = record%loss + energy(1) - gone(1)
         if (all(s == 0)) call note(event_rest, 0)
         call reopen()
      end subroutine strike

      !> Contacts that are shut open where their edges no longer press
      subroutine reopen()
         integer :: old(2)
         call motion%value_at(segment, t, ground(1), ground(2))
         old = s
         touching = s == 0
         if (.not. any(touching)) return
         call choose(body, touching, s, y(1:2), y(3:4), ground, x)
         do i = 1, 2
            if (old(i) == 0 .and. s(i) /= 0) call note(event_uplift, i)
         end do
         moved = moved .or. any(s /= 0)
         h_next = min(h_next, 1.0e-3_wp)
      end subroutine reopen

      subroutine note(kind, contact)
         integer(c_int), intent(in) :: kind
         integer, intent(in) :: contact
         record%events = record%events + 1
         if (record%events > size(record%event_kind)) return
         record%event_kind(record%events) = kind
         record%event(:, record%events) = [t, real(contact, wp)]
      end subroutine note

      subroutine note_peaks()
         integer :: k
         do k = 1, 2
            if (abs(y(k)) > abs(record%peak(k))) record%peak(k) = y(k)
         end do
      end subroutine note_peaks

      !> The output time that has come
      subroutine write_out()
         real(wp) :: shaking(2), a(2)
         do while (record%points < size(record%time))
            if (record%time(record%points + 1) > t) exit
            record%points = record%points + 1
            call motion%value_at(segment, t, shaking(1), shaking(2))
            a = solved(motion_about(body, s, y(1:2), y(3:4), shaking), s)
            record%state(:, record%points) = [y(1:4), shaking, energies(body, s, y(1:2), y(3:4)), y(5) - record%loss, &
               real(s, wp), contact_forces(body, s, y(1:2), y(3:4), a, shaking)]
         end do
      end subroutine write_out

   end subroutine stack_rock

end module rocking_stack
