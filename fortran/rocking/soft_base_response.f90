!> The response of a block on a base that gives way (rocking_soft_base) to a ground motion, mode by mode.
module rocking_soft_base_response
   use common_kinds, only : wp, gravity, pi
   use common_lists, only : event_impact => rocking_event_impact, event_uplift => rocking_event_uplift
   use common_signal, only : signal
   use common_status, only : status_invalid_argument
   use rocking_modes, only : mode_history, mode_rocker, respond_in_modes
   use rocking_soft_base, only : accelerations, base_contact, contact_of, decides, direction, lever, look, soft_base, &
      velocity, watched
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: soft_base_rock, soft_base_rows, soft_base_state

   !> Numbers of the state: q [rad], z [m], their rates, work of the ground, energy that the base has taken up [J]
   integer, parameter :: soft_base_state = 6
   !> Rows of a history: q, z, their rates, ground to +x and up [m/s^2], kinetic energy, potential energy with that of
   !> the springs, work of the ground less what the base took up [J], force of the base to +x and up [N], range of the
   !> base that pushes, from the foot [m], greatest pressure per length [N/m] or force of an edge [N], angular
   !> acceleration [rad/s^2]
   integer, parameter :: soft_base_rows = 15

   !> A block in one of its modes; events name the left (-1) or the right (1) edge
   type, extends(mode_rocker) :: soft_base_rocker
      type(soft_base) :: block
   contains
      procedure :: slope
      procedure :: inside
      procedure :: leave
      procedure :: fallen
      procedure :: row
   end type soft_base_rocker

contains

   !> Rock the block from a state until the end time or collapse
   subroutine soft_base_rock(block, motion, y, end_time, tolerance, history, status)
      type(soft_base), intent(in) :: block
      type(signal), intent(in) :: motion
      real(wp), intent(inout) :: y(:)     !! q [rad], z [m] and their rates, then zeros; at the end the state reached
      real(wp), intent(in) :: end_time    !! [s]
      real(wp), intent(in) :: tolerance   !! relative, per step
      type(mode_history), intent(inout) :: history
      integer(c_int), intent(out) :: status
      type(soft_base_rocker) :: rocker
      real(wp) :: atol(soft_base_state), stiffness, sunk, angle, unit

      status = status_invalid_argument
      if (size(y) /= soft_base_state) return
      rocker%block = block
      rocker%motion = motion
      ! a step that is longer than a cycle of the springs may be blind to it
      stiffness = block%stiffness * merge(2.0_wp, block%place(2) - block%place(1), block%edges)
      rocker%longest = min(rocker%longest, 0.25_wp * pi * sqrt(block%mass / stiffness))
      sunk = block%mass * gravity / stiffness
      angle = maxval(block%limit)
      unit = sqrt(gravity / block%height)
      atol(1:4) = 0.01_wp * tolerance * [angle, sunk, angle * unit, sqrt(gravity * sunk)]
      atol(5:6) = tolerance * block%mass * gravity * maxval(abs(block%place)) * angle
      call look(rocker%block, y)
      if (.not. abs(y(1)) > 0.0_wp) rocker%block%side = 1
      rocker%moved = any(rocker%block%down < 0)
      call respond_in_modes(rocker, y, end_time, atol, tolerance, history, status)
   end subroutine soft_base_rock

   !> Rates of the state
   function slope(system, t, y) result(rate)
      class(soft_base_rocker), intent(in) :: system
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp) :: rate(size(y))
      real(wp) :: shaking(2)
      type(base_contact) :: base
      shaking = system%ground(t)
      base = contact_of(system%block, y)
      rate(1:2) = y(3:4)
      rate(3:4) = accelerations(system%block, y, base, shaking)
      rate(5) = -system%block%mass * dot_product(shaking, velocity(system%block, y))
      rate(6) = base%spent
   end function slope

   !> Above zero while all signs stay
   function inside(body, t, y) result(margin)
      class(soft_base_rocker), intent(in) :: body
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp) :: margin
      real(wp) :: value(6)
      logical :: mask(6)
      value = watched(body%block, y)
      mask = decides(body%block)
      ! what stands upright leans to no side
      mask(6) = mask(6) .and. abs(value(6)) > 0.0_wp
      associate (b => body%block)
         margin = minval(value * real([b%down, b%push, b%root, b%side], wp), mask=mask)
      end associate
      associate (unused => t)
      end associate
   end function inside

   !> An edge lifts or lands, or its dashpot would pull
   subroutine leave(body, t, y, history)
      class(soft_base_rocker), intent(inout) :: body
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: y(:)
      type(mode_history), intent(inout) :: history
      integer :: before(2), i
      before = body%block%down
      call look(body%block, y)
      do i = 1, 2
         if (body%block%down(i) == before(i)) cycle
         if (body%block%down(i) < 0) then
            body%moved = .true.
            call history%note(event_uplift, t, 2 * i - 3)
         else
            history%impacts(i) = history%impacts(i) + 1
            call history%note(event_impact, t, 2 * i - 3)
         end if
      end do
   end subroutine leave

   !> The edge over which it has turned past recall: -1, 1, 0 none
   pure function fallen(body, y) result(place)
      class(soft_base_rocker), intent(in) :: body
      real(wp), intent(in) :: y(:)
      integer :: place
      place = 0
      if (y(1) <= -body%block%limit(1)) place = -1
      if (y(1) >= body%block%limit(2)) place = 1
   end function fallen

   !> What is stored of a state, see soft_base_rows
   function row(body, t, y, loss, rows) result(values)
      class(soft_base_rocker), intent(in) :: body
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: loss
      integer, intent(in) :: rows
      real(wp) :: values(rows)
      type(base_contact) :: base
      real(wp) :: shaking(2), a(2), x(2), d(2), kinetic, potential
      shaking = body%ground(t)
      associate (block => body%block)
         base = contact_of(block, y)
         a = accelerations(block, y, base, shaking)
         x = lever(block, y(1))
         d = direction(block, y(1))
         kinetic = 0.5_wp * block%inertia * y(3)**2
         if (block%linear) then
            kinetic = kinetic + 0.5_wp * block%mass * ((block%height * y(3))**2 + y(4)**2)
            potential = -block%mass * gravity * (y(2) + 0.5_wp * block%height * y(1)**2)
         else
            kinetic = kinetic + 0.5_wp * block%mass * sum(velocity(block, y)**2)
            potential = block%mass * gravity * (block%height * (d(2) - 1.0_wp) - y(2))
         end if
         values = [y(1:4), shaking, kinetic, potential + base%stored, y(5) - y(6) - loss, &
            block%mass * (x(1) * a(1) + x(2) * y(3)**2 + shaking(1)), base%force, base%range, base%most, a(1)]
      end associate
   end function row

end module rocking_soft_base_response
