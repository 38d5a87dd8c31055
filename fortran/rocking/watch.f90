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
      !> (joint and quantity N T E, input w h q'^2 and force of each restraint, 0 to panels, side)
      real(wp), allocatable :: value(:, :, :, :)
   contains
      procedure :: check_demand
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
      real(wp) :: x, t, weight(4), input(3), needed, beyond, normal, shear, moment
      integer :: first, j, k, l, joints

      x = max(q, 0.0_wp) / watch%critical(i)
      if (x > 1.0_wp) return
      x = x * real(watch%panels, wp)
      first = min(max(int(x) - 1, 0), watch%panels - 3)
      t = x - real(first, wp)
      weight = [-(t - 1.0_wp) * (t - 2.0_wp) * (t - 3.0_wp) / 6.0_wp, 0.5_wp * t * (t - 2.0_wp) * (t - 3.0_wp), &
         -0.5_wp * t * (t - 1.0_wp) * (t - 3.0_wp), t * (t - 1.0_wp) * (t - 2.0_wp) / 6.0_wp]
      input = [1.0_wp + vertical / gravity, real(3 - 2 * i, wp) * horizontal, v**2]
      joints = watch%joints
      do j = 1, joints
         normal = 0.0_wp
         shear = 0.0_wp
         moment = 0.0_wp
         do k = 1, 4
            associate (value => watch%value(:, :, first + k - 1, i))
               do l = 1, 3
                  normal = normal + weight(k) * input(l) * value(j, l)
                  shear = shear + weight(k) * input(l) * value(joints + j, l)
                  moment = moment + weight(k) * input(l) * value(2 * joints + j, l)
               end do
               do l = 1, watch%restraints
                  normal = normal + weight(k) * pull(l) * value(j, 3 + l)
                  shear = shear + weight(k) * pull(l) * value(joints + j, 3 + l)
                  moment = moment + weight(k) * pull(l) * value(2 * joints + j, 3 + l)
               end do
            end associate
         end do
         if (normal > 0.0_wp) then
            needed = abs(shear) / normal
            beyond = max(-moment / normal, moment / normal - 1.0_wp)
         else
            needed = huge(needed)
            beyond = huge(beyond)
         end if
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
   end subroutine check_demand

   !> Friction, outside, both times, both joints
   pure function flat(demand) result(list)
      class(joint_demand), intent(in) :: demand
      real(wp) :: list(demand_numbers)
      list = [demand%friction, demand%outside, demand%slips_at, demand%leaves_at, real(demand%slips, wp), &
         real(demand%leaves, wp)]
   end function flat

end module rocking_watch
