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
   integer, parameter :: drives = 12, rates = 4

   type :: joint_watch
      real(wp) :: tolerance = 0.0_wp       !! how far the resultant may leave a joint, over its length
      !> Horizontal acceleration of the ground at which the resting structure slides, of the sides +1 and -1 [m/s^2]
      real(wp) :: slides(2) = huge(1.0_wp)
      !> The same at which hinges of another mechanism open at rest [m/s^2]
      real(wp) :: opens(2) = huge(1.0_wp)
      integer :: joints = 0
      integer :: panels = 0                !! between rest and the critical rotation
      real(wp) :: critical(2) = 0.0_wp     !! [rad]
      integer :: restraints = 0
      real(wp), allocatable :: friction(:) !! (joints) coefficient that they have
      real(wp) :: least_friction = 0.0_wp  !! of them
      !> (joint and quantity N T E, input w h q'^2 and force of each restraint, 0 to panels, side)
      real(wp), allocatable :: value(:, :, :, :)
      !> (friction needed and how far outside, q'^2/w, h/w, panel, side) what no joint exceeds in a cell
      real(wp), allocatable :: bound(:, :, :, :, :)
      real(wp) :: per_rotation(2) = 0.0_wp !! panels for one rad
      real(wp) :: per_drive(2) = 0.0_wp    !! cells for one m/s^2 to +x, over w
      real(wp) :: per_rate(2) = 0.0_wp     !! cells for one rad^2/s^2 of q'^2/w
   contains
      procedure :: bound_demand
      procedure :: check_demand
      procedure :: changes_nothing
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

      if (watch%changes_nothing(i, q, v, horizontal, vertical, demand)) return
      x = max(q, 0.0_wp) / watch%critical(i)
      if (x > 1.0_wp) return
      input = [1.0_wp + vertical / gravity, real(3 - 2 * i, wp) * horizontal, v**2]
      call enter_forces(watch, i, x * real(watch%panels, wp), input, pull, time, demand)
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
      real(wp) :: weight, x, drive, rate, friction, outside
      answer = .false.
      if (.not. allocated(watch%bound)) return
      weight = 1.0_wp + vertical / gravity
      if (.not. weight > 0.0_wp) return
      weight = 1.0_wp / weight
      x = max(q, 0.0_wp) * watch%per_rotation(i)
      drive = horizontal * weight * watch%per_drive(i) + 0.5_wp * real(drives, wp)
      rate = v**2 * weight * watch%per_rate(i)
      if (.not. (x < real(watch%panels, wp) .and. drive >= 0.0_wp .and. drive < real(drives, wp) &
         .and. rate < real(rates, wp))) return
      friction = demand%friction
      if (demand%slips_at < 0.0_wp) friction = min(friction, watch%least_friction)
      outside = demand%outside
      if (demand%leaves_at < 0.0_wp) outside = min(outside, watch%tolerance)
      associate (bound => watch%bound(:, int(rate) + 1, int(drive) + 1, int(x) + 1, i))
         answer = bound(1) <= friction .and. bound(2) <= outside
      end associate
   end function changes_nothing

   !> Bounds of what the joints demand, for `changes_nothing`; none where restraints act.
   !>
   !> Over a panel the coefficients lie within the convex hull of the four control points of their cubic (Bernstein). That
   !> |T| <= m N, and that E >= -b N and E <= (1 + b) N, are linear in (w, h, q'^2)/w at each of them: they hold over a cell if
   !> they hold at its corners.
   pure subroutine bound_demand(watch, drive, rate, status)
      class(joint_watch), intent(inout) :: watch
      real(wp), intent(in) :: drive(2)       !! greatest |h/w|, of both sides [m/s^2]
      real(wp), intent(in) :: rate(2)        !! greatest q'^2/w [rad^2/s^2]
      integer(c_int), intent(out) :: status
      real(wp) :: most(2, 0:rates, 0:drives), here(2, 0:rates, 0:drives)
      integer :: i, k, n, panel, stat

      status = status_ok
      if (watch%restraints > 0 .or. any(drive <= 0.0_wp) .or. any(rate <= 0.0_wp)) return
      allocate (watch%bound(2, rates, drives, watch%panels, 2), stat=stat)
      status = merge(status_ok, status_out_of_memory, stat == 0)
      if (stat /= 0) return
      watch%per_rotation = real(watch%panels, wp) / watch%critical
      watch%per_drive = 0.5_wp * real(drives, wp) * [1.0_wp, -1.0_wp] / drive
      watch%per_rate = real(rates, wp) / rate
      do i = 1, 2
         call bound_corners(watch, i, 0, 1, here)
         do panel = 0, watch%panels - 1
            most = here
            do k = 2, 4
               call bound_corners(watch, i, panel, k, here)
               most = max(most, here)
            end do
            do n = 1, drives
               watch%bound(:, :, n, panel + 1, i) = max(max(most(:, :rates - 1, n - 1), most(:, 1:, n - 1)), &
                  max(most(:, :rates - 1, n), most(:, 1:, n)))
            end do
         end do
      end do
   end subroutine bound_demand

   !> What the joints demand at all corners of the cells, by a control point of the coefficients over a panel
   pure subroutine bound_corners(watch, i, panel, point, most)
      class(joint_watch), intent(in) :: watch
      integer, intent(in) :: i               !! of the side
      integer, intent(in) :: panel           !! from 0
      integer, intent(in) :: point           !! 1 to 4
      real(wp), intent(out) :: most(2, 0:rates, 0:drives)
      real(wp) :: weight(4), t, drive, rate, normal, shear, moment, beyond, coefficient(3 * watch%joints, 3)
      integer :: first, j, k, n, joints
      logical :: exact(watch%joints)

      joints = watch%joints
      first = min(max(panel - 1, 0), watch%panels - 3)
      t = real(panel - first + merge(0, 1, point < 3), wp)
      weight = weights(t)
      if (point == 2) weight = weight + slopes(t) / 3.0_wp
      if (point == 3) weight = weight - slopes(t) / 3.0_wp
      coefficient = 0.0_wp
      do k = 1, 4
         coefficient = coefficient + weight(k) * watch%value(:, :3, first + k - 1, i)
      end do
      ! A hinge, at one end of its joint whatever acts: without rounding
      do j = 1, joints
         associate (e => watch%value(2 * joints + j, :, :, i))
            exact(j) = all(abs(e) <= 0.0_wp) .or. all(abs(e - watch%value(j, :, :, i)) <= 0.0_wp)
         end associate
      end do
      most(1, :, :) = 0.0_wp
      most(2, :, :) = -1.0_wp
      do n = 0, drives
         drive = (real(n, wp) - 0.5_wp * real(drives, wp)) / abs(watch%per_drive(i))
         do k = 0, rates
            rate = real(k, wp) / watch%per_rate(i)
            do j = 1, joints
               associate (c => coefficient)
                  normal = c(j, 1) + drive * c(j, 2) + rate * c(j, 3)
                  shear = c(joints + j, 1) + drive * c(joints + j, 2) + rate * c(joints + j, 3)
                  moment = c(2 * joints + j, 1) + drive * c(2 * joints + j, 2) + rate * c(2 * joints + j, 3)
               end associate
               if (.not. normal > 0.0_wp) then
                  most(:, k, n) = huge(1.0_wp)
                  exit
               end if
               beyond = merge(0.0_wp, max(-moment / normal, moment / normal - 1.0_wp) + slack, exact(j))
               most(:, k, n) = max(most(:, k, n), [(1.0_wp + slack) * abs(shear) / normal, beyond])
            end do
         end do
      end do
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
      friction = demand%friction
      if (demand%slips_at < 0.0_wp) friction = min(friction, watch%least_friction)
      friction = friction * (1.0_wp - rounding)
      outside = demand%outside
      if (demand%leaves_at < 0.0_wp) outside = min(outside, watch%tolerance)
      outside = outside - rounding * (1.0_wp + abs(outside))
      critical = 0
      associate (normal => force(:watch%joints), shear => force(watch%joints + 1:2 * watch%joints), &
         moment => force(2 * watch%joints + 1:))
         do j = 1, watch%joints
            critical = critical + merge(0, 1, normal(j) > 0.0_wp .and. abs(shear(j)) <= friction * normal(j) &
               .and. -moment(j) <= outside * normal(j) .and. moment(j) - normal(j) <= outside * normal(j))
         end do
      end associate
      if (critical > 0) call judge_joints(watch, force, time, demand)
   end subroutine enter_forces

   !> Enter the forces at the joints one by one
   pure subroutine judge_joints(watch, force, time, demand)
      class(joint_watch), intent(in) :: watch
      real(wp), intent(in) :: force(:)       !! (joints of N, of T, of E) [N]
      real(wp), intent(in) :: time           !! [s]
      type(joint_demand), intent(inout) :: demand
      real(wp) :: needed, beyond
      integer :: j
      do j = 1, watch%joints
         associate (normal => force(j), shear => force(watch%joints + j), moment => force(2 * watch%joints + j))
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
      end do
   end subroutine judge_joints

   !> Friction, outside, both times, both joints
   pure function flat(demand) result(list)
      class(joint_demand), intent(in) :: demand
      real(wp) :: list(demand_numbers)
      list = [demand%friction, demand%outside, demand%slips_at, demand%leaves_at, real(demand%slips, wp), &
         real(demand%leaves, wp)]
   end function flat

end module rocking_watch
