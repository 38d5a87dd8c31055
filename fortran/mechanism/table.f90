!> The coefficients of a mechanism's equation of motion as polynomials of its coordinate, for one side of rocking.
!>
!> Where the parts come to lie in line the motion locks, and all coefficients have a branch point there: they are
!> smooth in sqrt(1 - q/L), not in q. The tables are therefore polynomials of w = 1 - sqrt(1 - q/L) on equal panels,
!> fitted at Chebyshev points to the mass, the gravity moment and the drive belonging to w, which stay finite:
!>
!>    M = M_w (dw/dq)^2,   V' = V_w dw/dq,   H = H_w dw/dq,   dq/dw = 2 L (1 - w).
!>
!> M' is the derivative of the fitted M and V the integral of the fitted V', so that energy is kept exactly by what
!> the integrator sees; both are held against the kinematics when the table is made.
module mechanism_table
   use common_kinds, only : wp, pi
   use common_status, only : status_ok, status_bad_geometry, status_energy_lost, status_invalid_argument, &
      status_out_of_memory
   use mechanism_linkage, only : coordinate, copy_state, linkage, linkage_coefficients, linkage_state
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: side_table, table_new, table_numbers, table_pack, table_unpack, table_facts
   public :: degree, lowest, panels, fit_polynomials, fit_angles

   !> Panels of a table, twice as many where the derivative of M needs them; more would add rounding to it
   integer, parameter :: panels = 32, most_panels = 2 * panels, degree = 11
   integer, parameter :: mass = 1, gravity_moment = 2, drive = 3
   !> Length of the flat list of one side: critical rotation, limit, end, L, number of panels, then the coefficients of
   !> each panel and its potential at the start
   integer, parameter :: table_numbers = 5 + most_panels * (3 * (degree + 1) + 1)

   real(wp), parameter :: reach = 1.6_wp  !! greatest rotation that is looked at [rad]
   integer, parameter :: scan = 400
   !> Where the first panel stops being continued below rest: only trial steps of the integrator get there
   real(wp), parameter :: lowest = -2.0_wp
   !> How far table and kinematics may differ, see table_facts
   real(wp), parameter :: agreement = 1.0e-9_wp

   type :: side_table
      !> q of unstable equilibrium, or of the lock where gravity resists up to there [rad]
      real(wp) :: critical = 0.0_wp
      real(wp) :: limit = 0.0_wp     !! q taken as collapse [rad]
      real(wp) :: last = 0.0_wp       !! last q of the table [rad]
      real(wp) :: scale = 1.0_wp     !! L [rad]
      integer :: count = panels           !! panels in use
      real(wp) :: per_panel = 0.0_wp !! panels per unit of w
      real(wp), allocatable :: coefficient(:, :, :)  !! (3, 0:degree, most_panels) of M_w, V_w, H_w by t in [-1, 1]
      real(wp), allocatable :: start(:)              !! (most_panels) potential at the start of each [J]
   contains
      procedure :: coefficients
      procedure :: potential
   end type side_table

   !> What became known while a table was made
   type :: table_facts
      real(wp) :: lock = 0.0_wp    !! greatest q that the hinges allow, or `reach` [rad]
      real(wp) :: m = 0.0_wp       !! M at rest [kg m^2]
      real(wp) :: dv = 0.0_wp      !! V' at rest [N m]
      real(wp) :: dh = 0.0_wp      !! H at rest [kg m]
      !> Greatest difference between table and kinematics at the ends of the panels: of M, V' and H as a share of
      !> themselves (V', H: at least of their values at rest)
      real(wp) :: misfit = 0.0_wp
      !> The same of energy: V over the barrier, and M'/2 at the points of the fit over M / limit
      real(wp) :: energy = 0.0_wp
   end type table_facts

contains

   !> Carry the mechanism from rest past its critical rotation and tabulate its coefficients
   subroutine table_new(mechanism, rest, side, table, facts, status)
      type(linkage), intent(in) :: mechanism
      type(linkage_state), intent(in) :: rest
      integer, intent(in) :: side             !! +1: it rocks to +x, -1 to -x
      type(side_table), intent(out) :: table
      type(table_facts), intent(out) :: facts
      !> status_bad_geometry where gravity does not hold the mechanism shut, status_energy_lost where table and
      !> kinematics disagree
      integer(c_int), intent(out) :: status
      real(wp) :: half_dm, v, barrier
      integer :: stat

      call linkage_coefficients(mechanism, rest, facts%m, half_dm, facts%dv, facts%dh, v)
      facts%dh = real(side, wp) * facts%dh
      status = status_bad_geometry
      if (.not. (facts%m > 0.0_wp .and. facts%dv > 0.0_wp .and. facts%dh > 0.0_wp)) return
      call find_limits(mechanism, rest, table%critical, barrier, facts%lock, status)
      if (status /= status_ok) return

      ! Beyond twice the critical rotation, or short of the lock, nothing brings the structure back.
      table%limit = min(2.0_wp * table%critical, 0.999_wp * facts%lock)
      ! Trial steps of the integrator look past it.
      table%last = table%limit + 0.5_wp * min(table%limit, facts%lock - table%limit)
      table%scale = merge(facts%lock, 4.0_wp * table%limit, facts%lock < min(reach, 4.0_wp * table%limit))
      allocate (table%coefficient(3, 0:degree, most_panels), table%start(most_panels), source=0.0_wp, stat=stat)
      if (stat /= 0) then
         status = status_out_of_memory
         return
      end if
      table%count = panels
      call fit_panels(mechanism, rest, side, barrier, table, facts, status)
      if (status == status_energy_lost) then
         table%count = most_panels
         call fit_panels(mechanism, rest, side, barrier, table, facts, status)
      end if
   end subroutine table_new

   !> Fit the coefficients on all panels in use and compare them with the kinematics
   subroutine fit_panels(mechanism, rest, side, barrier, table, facts, status)
      type(linkage), intent(in) :: mechanism
      type(linkage_state), intent(in) :: rest
      integer, intent(in) :: side             !! +1: it rocks to +x, -1 to -x
      real(wp), intent(in) :: barrier         !! potential at the critical rotation [J]
      type(side_table), intent(inout) :: table
      type(table_facts), intent(inout) :: facts
      integer(c_int), intent(out) :: status   !! status_energy_lost where table and kinematics disagree
      real(wp) :: v, angle(degree + 1), value(3, degree + 1), exact(degree + 1), per_w, w, panel_width
      type(linkage_state) :: here
      integer :: i, k

      facts%misfit = 0.0_wp
      facts%energy = 0.0_wp
      panel_width = table_coordinate(table, table%last) / real(table%count, wp)
      table%per_panel = 1.0_wp / panel_width
      angle = fit_angles()
      call copy_state(rest, here, status)
      if (status /= status_ok) return
      table%start(1) = 0.0_wp
      do i = 1, table%count
         do k = 1, degree + 1
            w = panel_width * (real(i, wp) - 0.5_wp + 0.5_wp * cos(angle(k)))
            call mechanism%carry_state(here, table%scale * w * (2.0_wp - w), status)
            if (status /= status_ok) return
            call linkage_coefficients(mechanism, here, value(mass, k), exact(k), value(gravity_moment, k), &
               value(drive, k), v)
            per_w = 2.0_wp * table%scale * (1.0_wp - w)
            value(:, k) = value(:, k) * [per_w**2, per_w, real(side, wp) * per_w]
         end do
         call fit_polynomials(angle, value, table%coefficient(:, :, i))
         do k = 1, degree + 1
            w = panel_width * (real(i, wp) - 0.5_wp + 0.5_wp * cos(angle(k)))
            call compare_mass(table, i, w, exact(k), facts%energy)
         end do
         w = panel_width * real(i, wp)
         call mechanism%carry_state(here, table%scale * w * (2.0_wp - w), status)
         if (status /= status_ok) return
         if (i < table%count) table%start(i + 1) = table%start(i) + climb(table, i, 1.0_wp)
         call enter_differences(mechanism, here, side, table, i, barrier, facts)
      end do
      if (.not. max(facts%misfit, facts%energy) <= agreement) status = status_energy_lost
   end subroutine fit_panels

   !> Critical rotation, the potential there, and the lock: walk out, then refine by bisection
   subroutine find_limits(mechanism, rest, critical, barrier, lock, status)
      type(linkage), intent(in) :: mechanism
      type(linkage_state), intent(in) :: rest
      real(wp), intent(out) :: critical
      real(wp), intent(out) :: barrier
      real(wp), intent(out) :: lock
      integer(c_int), intent(out) :: status
      type(linkage_state) :: here, next, balanced
      real(wp) :: q
      integer :: i

      critical = 0.0_wp
      barrier = 0.0_wp
      lock = reach
      call copy_state(rest, here, status)
      if (status /= status_ok) return
      do i = 1, scan
         q = reach * real(i, wp) / real(scan, wp)
         call mechanism%advance_state(here, q, next, status)
         if (status /= status_ok) return
         if (.not. next%closed) then
            call bisect_last_state(mechanism, here, q, .true., next, status)
            if (status /= status_ok) return
            call lock_of(mechanism, next, lock, status)
            if (status /= status_ok) return
         end if
         if (critical <= 0.0_wp .and. .not. (lock >= reach .and. resists(mechanism, next))) then
            ! Where gravity resists up to the lock itself, the structure snaps through there.
            if (resists(mechanism, next)) then
               call copy_state(next, balanced, status)
            else
               call bisect_last_state(mechanism, here, next%q, .false., balanced, status)
            end if
            if (status /= status_ok) return
            critical = min(balanced%q, lock)
            barrier = energy(mechanism, balanced)
         end if
         if (lock < reach) exit
         call copy_state(next, here, status)
         if (status /= status_ok) return
      end do
   end subroutine find_limits

   !> The last state before the hinges part, or before gravity turns over, between a closed state and a later q
   subroutine bisect_last_state(mechanism, from, high, for_lock, last, status)
      type(linkage), intent(in) :: mechanism
      type(linkage_state), intent(in) :: from
      real(wp), intent(in) :: high
      logical, intent(in) :: for_lock
      type(linkage_state), intent(inout) :: last  !! see copy_state
      integer(c_int), intent(out) :: status
      type(linkage_state) :: next
      real(wp) :: top
      logical :: before
      integer :: i

      call copy_state(from, last, status)
      if (status /= status_ok) return
      top = high
      do i = 1, 60
         call mechanism%advance_state(last, 0.5_wp * (last%q + top), next, status)
         if (status /= status_ok) return
         before = next%closed
         if (before .and. .not. for_lock) before = resists(mechanism, next)
         if (before) then
            call copy_state(next, last, status)
            if (status /= status_ok) return
         else
            top = 0.5_wp * (last%q + top)
         end if
      end do
   end subroutine bisect_last_state

   !> The q at which the mechanism locks, from a state just before.
   !>
   !> There the part that turns fastest is the better coordinate: by its rotation q has a smooth maximum, whose place
   !> Newton's method finds to rounding, while by q itself it is known to the square root of rounding only.
   subroutine lock_of(mechanism, before, lock, status)
      type(linkage), intent(in) :: mechanism
      type(linkage_state), intent(in) :: before
      real(wp), intent(out) :: lock
      integer(c_int), intent(out) :: status
      type(coordinate) :: fastest
      type(linkage_state) :: here
      real(wp) :: step
      integer :: k

      lock = before%q
      call copy_state(before, here, status)
      if (status /= status_ok) return
      fastest%driver = maxloc(abs(before%first(3, :)), 1)
      fastest%sense = sign(1.0_wp, before%first(3, fastest%driver))
      here%q = fastest%sense * here%place(3, fastest%driver)
      do k = 1, 20
         call mechanism%close_hinges(fastest, here, status)
         if (status /= status_ok .or. .not. here%closed) return
         step = -here%first(3, mechanism%by%driver) / here%second(3, mechanism%by%driver)
         if (.not. abs(step) <= 0.1_wp) return
         if (abs(step) <= 1.0e-14_wp) exit
         here%place(:, :) = here%place + step * here%first
         here%q = here%q + step
      end do
      lock = mechanism%by%sense * here%place(3, mechanism%by%driver)
   end subroutine lock_of

   !> Does gravity still push back to rest?
   pure function resists(mechanism, state) result(answer)
      type(linkage), intent(in) :: mechanism
      type(linkage_state), intent(in) :: state
      logical :: answer
      real(wp) :: m, half_dm, dv, dh, v
      call linkage_coefficients(mechanism, state, m, half_dm, dv, dh, v)
      answer = dv > 0.0_wp
   end function resists

   !> Potential energy above rest [J]
   pure function energy(mechanism, state) result(v)
      type(linkage), intent(in) :: mechanism
      type(linkage_state), intent(in) :: state
      real(wp) :: v
      real(wp) :: m, half_dm, dv, dh
      call linkage_coefficients(mechanism, state, m, half_dm, dv, dh, v)
   end function energy

   !> Angles whose cosines are the points of a fit in [-1, 1], ascending: the zeros of a Chebyshev polynomial
   pure function fit_angles() result(angle)
      real(wp) :: angle(degree + 1)
      integer :: k
      angle = [(pi * (real(k, wp) - 0.5_wp) / real(degree + 1, wp), k = degree + 1, 1, -1)]
   end function fit_angles

   !> Polynomials in t = cos(angle) through values at Chebyshev points
   pure subroutine fit_polynomials(angle, value, polynomial)
      real(wp), intent(in) :: angle(:)            !! (degree + 1)
      real(wp), intent(in) :: value(:, :)         !! (quantities, degree + 1)
      real(wp), intent(out) :: polynomial(:, 0:)  !! (quantities, 0:degree) coefficients of the powers of t
      real(wp) :: chebyshev(0:degree, 0:degree), cosine(degree + 1), weight, wave
      integer :: i, j, k

      ! Powers of t in each Chebyshev polynomial
      chebyshev = 0.0_wp
      chebyshev(0, 0) = 1.0_wp
      chebyshev(1, 1) = 1.0_wp
      do j = 2, degree
         chebyshev(1:, j) = 2.0_wp * chebyshev(:degree - 1, j - 1)
         chebyshev(:, j) = chebyshev(:, j) - chebyshev(:, j - 2)
      end do
      polynomial = 0.0_wp
      do j = 0, degree
         weight = merge(1.0_wp, 2.0_wp, j == 0) / real(degree + 1, wp)
         do k = 1, degree + 1
            cosine(k) = cos(real(j, wp) * angle(k))
         end do
         do i = 1, size(value, 1)
            wave = 0.0_wp
            do k = 1, degree + 1
               wave = wave + value(i, k) * cosine(k)
            end do
            do k = 0, degree
               polynomial(i, k) = polynomial(i, k) + weight * chebyshev(k, j) * wave
            end do
         end do
      end do
   end subroutine fit_polynomials

   !> Enter the differences of M, V', H and V at the end of panel i, where the kinematics are known
   pure subroutine enter_differences(mechanism, here, side, table, i, barrier, facts)
      type(linkage), intent(in) :: mechanism
      type(linkage_state), intent(in) :: here
      integer, intent(in) :: side
      type(side_table), intent(in) :: table
      integer, intent(in) :: i
      real(wp), intent(in) :: barrier
      type(table_facts), intent(inout) :: facts
      real(wp) :: m, half_dm, dv, dh, v, m_fit, half_dm_fit, dv_fit, dh_fit

      call linkage_coefficients(mechanism, here, m, half_dm, dv, dh, v)
      dh = real(side, wp) * dh
      call on_panel(table, i, table_coordinate(table, here%q), m_fit, half_dm_fit, dv_fit, dh_fit)
      facts%misfit = max(facts%misfit, abs(m_fit - m) / m, abs(dv_fit - dv) / max(abs(dv), facts%dv), &
         abs(dh_fit - dh) / max(abs(dh), facts%dh))
      facts%energy = max(facts%energy, abs(table%start(i) + climb(table, i, 1.0_wp) - v) / barrier)
   end subroutine enter_differences

   !> Enter the difference of M'/2 at a point of panel i
   pure subroutine compare_mass(table, i, w, half_dm, worst)
      type(side_table), intent(in) :: table
      integer, intent(in) :: i
      real(wp), intent(in) :: w
      real(wp), intent(in) :: half_dm
      real(wp), intent(inout) :: worst
      real(wp) :: m, half_dm_fit, dv, dh
      call on_panel(table, i, w, m, half_dm_fit, dv, dh)
      worst = max(worst, abs(half_dm_fit - half_dm) / max(m / table%limit, abs(half_dm)))
   end subroutine compare_mass

   !> w = 1 - sqrt(1 - q/L), without cancellation
   pure function table_coordinate(table, q) result(w)
      type(side_table), intent(in) :: table
      real(wp), intent(in) :: q
      real(wp) :: w
      w = q / table%scale
      w = w / (1.0_wp + sqrt(1.0_wp - w))
   end function table_coordinate

   !> Coefficients of the equation of motion, see rocking_rocker
   pure subroutine coefficients(sides, q, m, half_dm, dv, dh, closed)
      class(side_table), intent(in) :: sides
      real(wp), intent(in) :: q         !! rotation; also a little below zero [rad]
      real(wp), intent(out) :: m        !! M [kg m^2]
      real(wp), intent(out) :: half_dm  !! M'/2 [kg m^2]
      real(wp), intent(out) :: dv       !! V' [N m]
      real(wp), intent(out) :: dh       !! H [kg m]
      logical, intent(out) :: closed    !! false past the end of the table
      real(wp) :: w

      closed = q <= sides%last
      m = 0.0_wp
      half_dm = 0.0_wp
      dv = 0.0_wp
      dh = 0.0_wp
      if (.not. closed) return
      w = table_coordinate(sides, q)
      call on_panel(sides, panel_of(sides, w), w, m, half_dm, dv, dh)
   end subroutine coefficients

   !> The panel that holds w; the first also takes what lies below rest
   pure function panel_of(sides, w) result(i)
      class(side_table), intent(in) :: sides
      real(wp), intent(in) :: w
      integer :: i
      i = max(1, min(sides%count, 1 + int(w * sides%per_panel)))
   end function panel_of

   !> The coefficients by the polynomials of panel i
   pure subroutine on_panel(sides, i, w, m, half_dm, dv, dh)
      class(side_table), intent(in) :: sides
      integer, intent(in) :: i
      real(wp), intent(in) :: w
      real(wp), intent(out) :: m
      real(wp), intent(out) :: half_dm
      real(wp), intent(out) :: dv
      real(wp), intent(out) :: dh
      real(wp) :: t, value(3), slope, dw
      integer :: k

      t = max(lowest, 2.0_wp * (w * sides%per_panel - real(i - 1, wp)) - 1.0_wp)
      value = sides%coefficient(:, degree, i)
      slope = 0.0_wp
      do k = degree - 1, 0, -1
         slope = slope * t + value(mass)
         value = value * t + sides%coefficient(:, k, i)
      end do
      dw = 0.5_wp / (sides%scale * (1.0_wp - w))
      m = value(mass) * dw**2
      half_dm = (slope * sides%per_panel + value(mass) / (1.0_wp - w)) * dw**3
      dv = value(gravity_moment) * dw
      dh = value(drive) * dw
   end subroutine on_panel

   !> Potential energy of gravity above rest [J]
   pure function potential(sides, q) result(v)
      class(side_table), intent(in) :: sides
      real(wp), intent(in) :: q  !! not past the end of the table [rad]
      real(wp) :: v
      real(wp) :: w
      integer :: i
      w = table_coordinate(sides, q)
      i = panel_of(sides, w)
      v = sides%start(i) + climb(sides, i, 2.0_wp * (w * sides%per_panel - real(i - 1, wp)) - 1.0_wp)
   end function potential

   !> Rise of the potential from the start of a panel, t = -1 [J]
   pure function climb(sides, i, t) result(v)
      class(side_table), intent(in) :: sides
      integer, intent(in) :: i
      real(wp), intent(in) :: t
      real(wp) :: v
      real(wp) :: low
      integer :: k
      v = 0.0_wp
      low = 0.0_wp
      do k = degree, 0, -1
         v = v * t + sides%coefficient(gravity_moment, k, i) / real(k + 1, wp)
         low = -low + sides%coefficient(gravity_moment, k, i) / real(k + 1, wp)
      end do
      v = 0.5_wp * (v * t + low) / sides%per_panel
   end function climb

   !> The flat list of a table
   pure subroutine table_pack(table, list)
      type(side_table), intent(in) :: table
      real(wp), intent(out) :: list(:)  !! (table_numbers)
      integer :: n
      n = 3 * (degree + 1) * most_panels
      list(1:5) = [table%critical, table%limit, table%last, table%scale, real(table%count, wp)]
      list(6:5 + n) = reshape(table%coefficient, [n])
      list(6 + n:table_numbers) = table%start
   end subroutine table_pack

   !> A table from its flat list
   pure subroutine table_unpack(list, table, status)
      real(wp), intent(in) :: list(:)         !! (table_numbers)
      type(side_table), intent(out) :: table
      integer(c_int), intent(out) :: status
      integer :: n, stat

      n = 3 * (degree + 1) * most_panels
      status = status_invalid_argument
      if (size(list) /= table_numbers) return
      table%critical = list(1)
      table%limit = list(2)
      table%last = list(3)
      table%scale = list(4)
      if (.not. (table%critical > 0.0_wp .and. table%limit > 0.0_wp)) return
      if (.not. (table%last >= table%limit .and. table%scale > table%last)) return
      if (.not. (list(5) >= 1.0_wp .and. list(5) <= real(most_panels, wp))) return
      table%count = nint(list(5))
      allocate (table%coefficient(3, 0:degree, most_panels), table%start(most_panels), stat=stat)
      status = merge(status_ok, status_out_of_memory, stat == 0)
      if (stat /= 0) return
      table%per_panel = real(table%count, wp) / table_coordinate(table, table%last)
      table%coefficient(:, :, :) = reshape(list(6:5 + n), [3, degree + 1, most_panels])
      table%start(:) = list(6 + n:table_numbers)
   end subroutine table_unpack

end module mechanism_table
