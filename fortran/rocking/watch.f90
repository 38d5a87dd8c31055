!> What the joints of a rocking structure must carry while it rocks: friction, and the place of the thrust line.
!>
!> Of one degree of freedom the forces across a joint are linear in w = 1 + a_v/g, in the ground acceleration
!> towards the other side, h = side a_h, and in the square of the rate, with coefficients that depend on the rotation:
!>
!>    (N, T, E) = C_w(q) w + C_h(q) h + C_v(q) q'^2,
!>
!> N the compression, T the shear, E = M_p / L the moment about the end p over the length, so that the resultant meets
!> the joint at the share E/N of its length. Restraints add C_k(q) f_k, f_k the force of each in that state. The coefficients
!> are tabulated at equal steps from rest to the critical rotation and read by cubics through four neighbours; beyond it
!> nothing is looked at.
module rocking_watch
   use common_kinds, only : wp, gravity
   use common_status, only : status_ok, status_invalid_argument, status_out_of_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: joint_demand, joint_watch, joint_watch_new, demand_numbers

   !> Length of the flat list of a demand
   integer, parameter :: demand_numbers = 6
   !> Room for the rounding of a product and a quotient
   real(wp), parameter :: rounding = 1.0e-14_wp
   !> Room for the same in a bound
   real(wp), parameter :: slack = 1.0e-9_wp
   !> Cells of the bounds over h/w, over q'^2/w
   integer, parameter :: drives = 16, rates = 4
   !> Runs that repay the bounds over a panel
   integer, parameter :: runs_per_panel = 16

   type :: joint_watch
      real(wp) :: tolerance = 0.0_wp       !! how far the resultant may leave a joint, over its length
      !> Horizontal acceleration of the ground at which the resting structure slides, of the sides +1 and -1 [m/s^2]
      real(wp) :: slides(2) = huge(1.0_wp)
      !> The same at which hinges of another mechanism open at rest [m/s^2]
      real(wp) :: opens(2) = huge(1.0_wp)
      integer :: joints = 0
      integer :: panels = 0                !! between rest and the critical rotation
      integer :: bounded = 0               !! of them, from rest
      real(wp) :: critical(2) = 0.0_wp     !! [rad]
      integer :: restraints = 0
      real(wp), allocatable :: friction(:) !! (joints) coefficient that they have
      real(wp) :: least_friction = 0.0_wp  !! of them
      !> (joint and quantity N T E, input w h q'^2 and force of each restraint, 0 to panels, side)
      real(wp), allocatable :: value(:, :, :, :)
      !> (joint, friction needed and how far outside, cell) what a joint does not exceed in a cell of q'^2/w, h/w, panel, side
      real(wp), allocatable :: bound(:, :, :)
      !> (friction needed and how far outside, cell) the greatest bound of all joints
      real(wp), allocatable :: most(:, :)
      real(wp) :: per_rotation(2) = 0.0_wp !! panels for one rad
      real(wp) :: per_drive(2) = 0.0_wp    !! cells for one m/s^2 to +x, over w
      real(wp) :: per_rate(2) = 0.0_wp     !! cells for one rad^2/s^2 of q'^2/w
   contains
      procedure :: bound_demand
      procedure :: check_demand
      procedure :: changes_nothing
      procedure :: changes_nothing_between
   end type joint_watch

   !> What a run demanded of the joints, up to the critical rotation
   type :: joint_demand
      real(wp) :: friction = 0.0_wp        !! greatest coefficient needed; huge in tension
      real(wp) :: outside = -1.0_wp        !! how far the resultant left a joint, over its length; below 0: inside
      real(wp) :: slips_at = -1.0_wp       !! first time at which it exceeds that of the joints [s]; -1: never
      real(wp) :: leaves_at = -1.0_wp      !! first time at which the resultant leaves by more than the tolerance [s]
      integer :: slips = 0                 !! the joint where it slips first, 1-based; 0: at rest, or never
      integer :: leaves = 0                !! the joint where the resultant leaves first; 0: at rest, or never
   contains
      procedure :: flat
   end type joint_demand

contains

   !> From a flat list: tolerance, accelerations that slide it to both sides, that open other hinges [m/s^2], joints, panels,
   !> both critical rotations, restraints, friction of the joints, the values in their order
   subroutine joint_watch_new(list, restraints, watch, status)
      real(wp), intent(in) :: list(:)
      integer, intent(in) :: restraints  !! of the structure
      type(joint_watch), intent(out) :: watch
      integer(c_int), intent(out) :: status
      integer, parameter :: head = 10
      integer :: last, rows, stat

      status = status_invalid_argument
      if (size(list) < head) return
      if (any(list(1:5) < 0.0_wp) .or. any(list(8:9) <= 0.0_wp)) return
      if (any(list(6:7) < [1.0_wp, 4.0_wp]) .or. any(list(6:7) > real(size(list), wp))) return
      if (nint(min(max(list(10), -1.0_wp), 1.0e9_wp)) /= restraints) return
      watch%tolerance = list(1)
      watch%slides = list(2:3)
      watch%opens = list(4:5)
      watch%joints = nint(list(6))
      watch%panels = nint(list(7))
      watch%critical = list(8:9)
      watch%restraints = restraints
      rows = 6 * (3 + restraints)
      if (real(size(list), wp) < real(head, wp) + list(6) * (1.0_wp + real(rows, wp) * (list(7) + 1.0_wp)) - 0.5_wp) return
      last = head + watch%joints
      if (size(list) /= last + rows * watch%joints * (watch%panels + 1)) return
      allocate (watch%friction(watch%joints), watch%value(3 * watch%joints, 3 + restraints, 0:watch%panels, 2), stat=stat)
      status = merge(status_ok, status_out_of_memory, stat == 0)
      if (stat /= 0) return
      watch%friction(:) = list(head + 1:last)
      watch%least_friction = minval(watch%friction)
      watch%value(:, :, :, :) = reshape(list(last + 1:), [3 * watch%joints, 3 + restraints, watch%panels + 1, 2])
   end subroutine joint_watch_new

   !> Enter what the joints must carry in a state
   pure subroutine check_demand(watch, i, q, v, horizontal, vertical, pull, time, demand)
      class(joint_watch), intent(in) :: watch
      integer, intent(in) :: i               !! 1 rocking to +x, 2 to -x
      real(wp), intent(in) :: q              !! rotation [rad]
      real(wp), intent(in) :: v              !! its rate [rad/s]
      real(wp), intent(in) :: horizontal     !! ground acceleration to +x [m/s^2]
      real(wp), intent(in) :: vertical       !! ground acceleration, up [m/s^2]
      real(wp), intent(in) :: pull(:)        !! (restraints) their forces [N], of turns [N m]
      real(wp), intent(in) :: time           !! [s]
      type(joint_demand), intent(inout) :: demand
      real(wp) :: x, input(3)
      integer :: cell

      cell = cell_at(watch, i, q, v, horizontal, vertical)
      if (cell > 0) then
         if (cell_changes_nothing(watch, cell, demand)) return
      end if
      x = max(q, 0.0_wp) / watch%critical(i)
      if (x > 1.0_wp) return
      input = [1.0_wp + vertical / gravity, real(3 - 2 * i, wp) * horizontal, v**2]
      if (cell > 0) then
         call enter_some(watch, i, cell, x * real(watch%panels, wp), input, time, demand)
      else
         call enter_forces(watch, i, x * real(watch%panels, wp), input, pull, time, demand)
      end if
   end subroutine check_demand

   !> Do the bounds show that a state changes nothing in a demand? See check_demand
   pure function changes_nothing(watch, i, q, v, horizontal, vertical, demand) result(answer)
      class(joint_watch), intent(in) :: watch
      integer, intent(in) :: i               !! of the side
      real(wp), intent(in) :: q              !! [rad]
      real(wp), intent(in) :: v              !! [rad/s]
      real(wp), intent(in) :: horizontal     !! [m/s^2]
      real(wp), intent(in) :: vertical       !! [m/s^2]
      type(joint_demand), intent(in) :: demand
      logical :: answer
      integer :: cell
      cell = cell_at(watch, i, q, v, horizontal, vertical)
      answer = cell > 0
      if (answer) answer = cell_changes_nothing(watch, cell, demand)
   end function changes_nothing

   !> The cell of the bounds in which a state lies, see check_demand; 0 beyond the cells, and where nothing is bounded
   pure function cell_at(watch, i, q, v, horizontal, vertical) result(cell)
      class(joint_watch), intent(in) :: watch
      integer, intent(in) :: i               !! of the side
      real(wp), intent(in) :: q              !! [rad]
      real(wp), intent(in) :: v              !! [rad/s]
      real(wp), intent(in) :: horizontal     !! [m/s^2]
      real(wp), intent(in) :: vertical       !! [m/s^2]
      integer :: cell
      real(wp) :: weight, x, drive, rate
      cell = 0
      if (.not. allocated(watch%most)) return
      weight = 1.0_wp
      if (abs(vertical) > 0.0_wp) then
         weight = 1.0_wp + vertical / gravity
         if (.not. weight > 0.0_wp) return
         weight = 1.0_wp / weight
      end if
      x = max(q, 0.0_wp) * watch%per_rotation(i)
      drive = horizontal * weight * watch%per_drive(i) + 0.5_wp * real(drives, wp)
      rate = v**2 * weight * watch%per_rate(i)
      if (x < real(watch%bounded, wp) .and. drive >= 0.0_wp .and. drive < real(drives, wp) .and. rate < real(rates, wp)) then
         cell = cell_number(watch, i, int(rate), int(drive), int(x))
      end if
   end function cell_at

   !> Number of a cell
   pure function cell_number(watch, i, rate, drive, panel) result(cell)
      class(joint_watch), intent(in) :: watch
      integer, intent(in) :: i                  !! of the side
      integer, intent(in) :: rate, drive, panel !! each from 0
      integer :: cell
      cell = 1 + rate + rates * (drive + drives * (panel + watch%bounded * (i - 1)))
   end function cell_number

   !> Does no joint change anything in a demand, wherever in a cell the state lies?
   pure function cell_changes_nothing(watch, cell, demand) result(answer)
      class(joint_watch), intent(in) :: watch
      integer, intent(in) :: cell            !! see cell_at
      type(joint_demand), intent(in) :: demand
      logical :: answer
      answer = watch%most(1, cell) <= unchanged(demand%friction, demand%slips_at, watch%least_friction) &
         .and. watch%most(2, cell) <= unchanged(demand%outside, demand%leaves_at, watch%tolerance)
   end function cell_changes_nothing

   !> Up to where a value changes neither a greatest one, nor a limit that was not exceeded yet
   pure function unchanged(greatest, failed_at, limit) result(value)
      real(wp), intent(in) :: greatest
      real(wp), intent(in) :: failed_at  !! first time above the limit [s]; below 0: never
      real(wp), intent(in) :: limit
      real(wp) :: value
      value = greatest
      if (failed_at < 0.0_wp) value = min(value, limit)
   end function unchanged

   !> Do the bounds show that no state between two changes anything in a demand, while the ground goes in straight lines?
   pure function changes_nothing_between(watch, i, q, v, horizontal, vertical, demand) result(answer)
      class(joint_watch), intent(in) :: watch
      integer, intent(in) :: i               !! of the side
      real(wp), intent(in) :: q(2)           !! least and greatest rotation [rad]
      real(wp), intent(in) :: v(2)           !! the same of the size of the rate [rad/s]
      real(wp), intent(in) :: horizontal(2)  !! at the beginning and at the end [m/s^2]
      real(wp), intent(in) :: vertical(2)    !! [m/s^2]
      type(joint_demand), intent(in) :: demand
      logical :: answer
      real(wp) :: weight(2), x(2), drive(2), rate(2), friction, outside
      integer :: first(3), last(3), cell, n, panel
      answer = .false.
      if (.not. allocated(watch%most)) return
      weight = 1.0_wp + vertical / gravity
      if (.not. all(weight > 0.0_wp)) return
      x = max(q, 0.0_wp) * watch%per_rotation(i)
      drive = horizontal / weight * watch%per_drive(i) + 0.5_wp * real(drives, wp)
      rate = v**2 / [maxval(weight), minval(weight)] * watch%per_rate(i)
      if (.not. (x(2) < real(watch%bounded, wp) .and. all(drive >= 0.0_wp .and. drive < real(drives, wp)) &
         .and. rate(2) < real(rates, wp))) return
      first = [int(rate(1)), int(minval(drive)), int(x(1))]
      last = [int(rate(2)), int(maxval(drive)), int(x(2))]
      friction = unchanged(demand%friction, demand%slips_at, watch%least_friction)
      outside = unchanged(demand%outside, demand%leaves_at, watch%tolerance)
      do panel = first(3), last(3)
         do n = first(2), last(2)
            do cell = cell_number(watch, i, first(1), n, panel), cell_number(watch, i, last(1), n, panel)
               if (watch%most(1, cell) > friction .or. watch%most(2, cell) > outside) return
            end do
         end do
      end do
      answer = .true.
   end function changes_nothing_between

   !> Bounds of what the joints demand, for `changes_nothing`; none where restraints act.
   !>
   !> Over a panel the coefficients lie within the convex hull of the four control points of their cubic (Bernstein). That
   !> |T| <= m N, and that E >= -b N and E <= (1 + b) N, are linear in (w, h, q'^2)/w at each of them: they hold over a cell if
   !> they hold at its corners.
   pure subroutine bound_demand(watch, runs, drive, rate, status)
      class(joint_watch), intent(inout) :: watch
      integer, intent(in) :: runs            !! few do not repay the bounds of great rotations
      real(wp), intent(in) :: drive(2)       !! greatest |h/w|, of both sides [m/s^2]
      real(wp), intent(in) :: rate(2)        !! greatest q'^2/w [rad^2/s^2]
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: most(:, :, :, :), here(:, :, :, :)
      integer :: i, k, n, panel, cell, stat

      status = status_ok
      if (watch%restraints > 0 .or. any(drive <= 0.0_wp) .or. any(rate <= 0.0_wp)) return
      watch%bounded = min(watch%panels, max(4, runs / runs_per_panel))
      cell = 2 * watch%bounded * drives * rates
      allocate (watch%bound(watch%joints, 2, cell), most(watch%joints, 2, 0:rates, 0:drives), &
         here(watch%joints, 2, 0:rates, 0:drives), stat=stat)
      if (stat == 0) allocate (watch%most(2, cell), stat=stat)
      status = merge(status_ok, status_out_of_memory, stat == 0)
      if (stat /= 0) return
      watch%per_rotation = real(watch%panels, wp) / watch%critical
      watch%per_drive = 0.5_wp * real(drives, wp) * [1.0_wp, -1.0_wp] / drive
      watch%per_rate = real(rates, wp) / rate
      do i = 1, 2
         call bound_corners(watch, i, 0, 1, here)
         do panel = 0, watch%bounded - 1
            most(:, :, :, :) = here
            do k = 2, 4
               call bound_corners(watch, i, panel, k, here)
               most(:, :, :, :) = max(most, here)
            end do
            do n = 1, drives
               do k = 1, rates
                  cell = cell_number(watch, i, k - 1, n - 1, panel)
                  watch%bound(:, :, cell) = max(max(most(:, :, k - 1, n - 1), most(:, :, k, n - 1)), &
                     max(most(:, :, k - 1, n), most(:, :, k, n)))
                  watch%most(:, cell) = maxval(watch%bound(:, :, cell), dim=1)
               end do
            end do
         end do
      end do
   end subroutine bound_demand

   !> What each joint demands at all corners of the cells, by a control point of the coefficients over a panel
   pure subroutine bound_corners(watch, i, panel, point, most)
      class(joint_watch), intent(in) :: watch
      integer, intent(in) :: i               !! of the side
      integer, intent(in) :: panel           !! from 0
      integer, intent(in) :: point           !! 1 to 4
      real(wp), intent(out), contiguous :: most(:, :, 0:, 0:)  !! (joints, friction needed and how far outside, rates, drives)
      real(wp) :: weight(4), t, drive, rate, normal, shear, moment, beyond
      real(wp) :: coefficient(watch%joints, 3, 3), share(watch%joints)
      integer :: first, j, k, n, joints

      joints = watch%joints
      first = min(max(panel - 1, 0), watch%panels - 3)
      t = real(panel - first + merge(0, 1, point < 3), wp)
      weight = weights(t)
      if (point == 2) weight = weight + slopes(t) / 3.0_wp
      if (point == 3) weight = weight - slopes(t) / 3.0_wp
      coefficient = 0.0_wp
      do k = 1, 4
         coefficient = coefficient + weight(k) * reshape(watch%value(:, :3, first + k - 1, i), shape(coefficient))
      end do
      ! A hinge, at one end of its joint whatever acts: without rounding
      do j = 1, joints
         associate (e => watch%value(2 * joints + j, :, :, i))
            share(j) = merge(0.0_wp, 1.0_wp, all(abs(e) <= 0.0_wp) .or. all(abs(e - watch%value(j, :, :, i)) <= 0.0_wp))
         end associate
      end do
      associate (c => coefficient)
         do n = 0, drives
            drive = (real(n, wp) - 0.5_wp * real(drives, wp)) / abs(watch%per_drive(i))
            do k = 0, rates
               rate = real(k, wp) / watch%per_rate(i)
               do j = 1, joints
                  normal = c(j, 1, 1) + drive * c(j, 1, 2) + rate * c(j, 1, 3)
                  shear = c(j, 2, 1) + drive * c(j, 2, 2) + rate * c(j, 2, 3)
                  moment = c(j, 3, 1) + drive * c(j, 3, 2) + rate * c(j, 3, 3)
                  beyond = share(j) * (max(-moment, moment - normal) / normal + slack)
                  most(j, 1, k, n) = merge((1.0_wp + slack) * abs(shear) / normal, huge(1.0_wp), normal > 0.0_wp)
                  most(j, 2, k, n) = merge(beyond, huge(1.0_wp), normal > 0.0_wp)
               end do
            end do
         end do
      end associate
   end subroutine bound_corners

   !> Of the cubic through values at 0, 1, 2, 3, at t
   pure function weights(t) result(weight)
      real(wp), intent(in) :: t
      real(wp) :: weight(4)
      weight = [-(t - 1.0_wp) * (t - 2.0_wp) * (t - 3.0_wp) / 6.0_wp, 0.5_wp * t * (t - 2.0_wp) * (t - 3.0_wp), &
         -0.5_wp * t * (t - 1.0_wp) * (t - 3.0_wp), t * (t - 1.0_wp) * (t - 2.0_wp) / 6.0_wp]
   end function weights

   !> Their derivatives
   pure function slopes(t) result(slope)
      real(wp), intent(in) :: t
      real(wp) :: slope(4)
      slope = [-(3.0_wp * t**2 - 12.0_wp * t + 11.0_wp) / 6.0_wp, 0.5_wp * (3.0_wp * t**2 - 10.0_wp * t + 6.0_wp), &
         -0.5_wp * (3.0_wp * t**2 - 8.0_wp * t + 3.0_wp), (3.0_wp * t**2 - 6.0_wp * t + 2.0_wp) / 6.0_wp]
   end function slopes

   !> Enter the forces in a state
   pure subroutine enter_forces(watch, i, x, input, pull, time, demand)
      class(joint_watch), intent(in) :: watch
      integer, intent(in) :: i               !! of the side
      real(wp), intent(in) :: x              !! rotation in panels
      real(wp), intent(in) :: input(3)       !! w, h, q'^2
      real(wp), intent(in) :: pull(:)        !! (restraints) [N, N m]
      real(wp), intent(in) :: time           !! [s]
      type(joint_demand), intent(inout) :: demand
      real(wp) :: weight(4), force(3 * watch%joints), friction, outside
      integer :: first, j, k, l, critical

      first = min(max(int(x) - 1, 0), watch%panels - 3)
      weight = weights(x - real(first, wp))
      force = 0.0_wp
      do k = 1, 4
         associate (value => watch%value(:, :, first + k - 1, i), load => weight(k) * input)
            do j = 1, 3 * watch%joints
               force(j) = force(j) + load(1) * value(j, 1) + load(2) * value(j, 2) + load(3) * value(j, 3)
            end do
            do l = 1, watch%restraints
               do j = 1, 3 * watch%joints
                  force(j) = force(j) + weight(k) * pull(l) * value(j, 3 + l)
               end do
            end do
         end associate
      end do
      ! What changes nothing, by products; the rounding of a quotient is left to the joints one by one
      friction = (1.0_wp - rounding) * unchanged(demand%friction, demand%slips_at, watch%least_friction)
      outside = unchanged(demand%outside, demand%leaves_at, watch%tolerance)
      outside = outside - rounding * (1.0_wp + abs(outside))
      critical = 0
      associate (normal => force(:watch%joints), shear => force(watch%joints + 1:2 * watch%joints), &
         moment => force(2 * watch%joints + 1:))
         do j = 1, watch%joints
            critical = critical + merge(0, 1, normal(j) > 0.0_wp .and. abs(shear(j)) <= friction * normal(j) &
               .and. -moment(j) <= outside * normal(j) .and. moment(j) - normal(j) <= outside * normal(j))
         end do
      end associate
      if (critical == 0) return
      do j = 1, watch%joints
         call judge_joint(watch, j, [force(j), force(watch%joints + j), force(2 * watch%joints + j)], time, demand)
      end do
   end subroutine enter_forces

   !> Enter the forces of the joints whose bounds in a cell could change the demand, where no restraint acts; see enter_forces
   pure subroutine enter_some(watch, i, cell, x, input, time, demand)
      class(joint_watch), intent(in) :: watch
      integer, intent(in) :: i               !! of the side
      integer, intent(in) :: cell            !! see cell_at
      real(wp), intent(in) :: x              !! rotation in panels
      real(wp), intent(in) :: input(3)       !! w, h, q'^2
      real(wp), intent(in) :: time           !! [s]
      type(joint_demand), intent(inout) :: demand
      real(wp) :: weight(4), load(3), force(3), friction, outside
      integer :: first, j, k, l

      first = min(max(int(x) - 1, 0), watch%panels - 3)
      weight = weights(x - real(first, wp))
      friction = unchanged(demand%friction, demand%slips_at, watch%least_friction)
      outside = unchanged(demand%outside, demand%leaves_at, watch%tolerance)
      do j = 1, watch%joints
         if (watch%bound(j, 1, cell) <= friction .and. watch%bound(j, 2, cell) <= outside) cycle
         force = 0.0_wp
         do k = 1, 4
            load = weight(k) * input
            associate (value => watch%value(:, :, first + k - 1, i))
               do l = 1, 3
                  force(l) = force(l) + load(1) * value((l - 1) * watch%joints + j, 1) &
                     + load(2) * value((l - 1) * watch%joints + j, 2) + load(3) * value((l - 1) * watch%joints + j, 3)
               end do
            end associate
         end do
         call judge_joint(watch, j, force, time, demand)
         friction = unchanged(demand%friction, demand%slips_at, watch%least_friction)
         outside = unchanged(demand%outside, demand%leaves_at, watch%tolerance)
      end do
   end subroutine enter_some

   !> Enter the forces at a joint
   pure subroutine judge_joint(watch, j, force, time, demand)
      class(joint_watch), intent(in) :: watch
      integer, intent(in) :: j
      real(wp), intent(in) :: force(3)       !! N, T, E [N]
      real(wp), intent(in) :: time           !! [s]
      type(joint_demand), intent(inout) :: demand
      real(wp) :: needed, beyond
      associate (normal => force(1), shear => force(2), moment => force(3))
         if (normal > 0.0_wp) then
            needed = abs(shear) / normal
            beyond = max(-moment / normal, moment / normal - 1.0_wp)
         else
            needed = huge(needed)
            beyond = huge(beyond)
         end if
      end associate
      if (needed > watch%friction(j) .and. demand%slips_at < 0.0_wp) then
         demand%slips_at = time
         demand%slips = j
      end if
      if (beyond > watch%tolerance .and. demand%leaves_at < 0.0_wp) then
         demand%leaves_at = time
         demand%leaves = j
      end if
      demand%friction = max(demand%friction, needed)
      demand%outside = max(demand%outside, beyond)
   end subroutine judge_joint

   !> Friction, outside, both times, both joints
   pure function flat(demand) result(list)
      class(joint_demand), intent(in) :: demand
      real(wp) :: list(demand_numbers)
      list = [demand%friction, demand%outside, demand%slips_at, demand%leaves_at, real(demand%slips, wp), &
         real(demand%leaves, wp)]
   end function flat

end module rocking_watch
