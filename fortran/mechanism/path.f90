!> How far points of a mechanism move as its coordinate grows, as polynomials: what is tied to it follows from these.
!>
!> Polynomials of w = 1 - sqrt(1 - q/L) on equal panels as in mechanism_table, and for the same reason. The rate of a
!> path is the derivative of its polynomial, so that a force that derives from an energy of the path keeps that energy.
module mechanism_path
   use common_kinds, only : wp
   use common_status, only : status_ok, status_invalid_argument, status_out_of_memory
   use mechanism_linkage, only : copy_state, linkage, linkage_state, part_place
   use mechanism_table, only : degree, fit_polynomials, fit_angles, lowest, panels
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: path_table, path_new, path_numbers, path_pack, path_unpack, sort_length, sort_turn

   !> What a path measures: the length of the line between two points, over that at rest [m]; the turn of the first part
   !> against the second, counter-clockwise [rad]
   integer, parameter :: sort_length = 1, sort_turn = 2

   type :: path_table
      integer :: count = 0           !! of paths
      real(wp) :: scale = 1.0_wp     !! L [rad]
      real(wp) :: per_panel = 0.0_wp !! panels per unit of w
      real(wp), allocatable :: coefficient(:, :, :)  !! (count, 0:degree, panels) by t in [-1, 1]
   contains
      procedure :: evaluate_path
   end type path_table

contains

   !> Length of the flat list of a table of some paths: L, panels per unit of w, the coefficients
   pure function path_numbers(count) result(numbers)
      integer, intent(in) :: count
      integer :: numbers
      numbers = 2 + panels * (degree + 1) * count
   end function path_numbers

   !> Carry the mechanism from rest to its last rotation and tabulate paths
   subroutine path_new(mechanism, rest, sort, ends, point, last, scale, table, status)
      type(linkage), intent(in) :: mechanism
      type(linkage_state), intent(in) :: rest
      integer(c_int), intent(in) :: sort(:)    !! (count), see sort_length
      integer(c_int), intent(in) :: ends(:, :)              !! (2, count) parts at both ends, 0 = ground
      real(wp), intent(in), contiguous :: point(:, :, :)    !! (2, 2, count) x, y of both ends at rest [m]
      real(wp), intent(in) :: last             !! greatest rotation of the table [rad]
      real(wp), intent(in) :: scale            !! L [rad]
      type(path_table), intent(out) :: table
      integer(c_int), intent(out) :: status    !! status_bad_geometry where the hinges part before `last`
      real(wp) :: angle(degree + 1), w, width
      real(wp), allocatable :: value(:, :)
      type(linkage_state) :: here
      integer(c_int) :: both(2)
      integer :: i, j, k, stat

      status = status_invalid_argument
      if (.not. (last > 0.0_wp .and. scale > last) .or. any(ends < 0) .or. any(ends > mechanism%parts)) return
      if (any(sort < sort_length) .or. any(sort > sort_turn)) return
      table%count = size(sort)
      table%scale = scale
      allocate (table%coefficient(table%count, 0:degree, panels), value(table%count, degree + 1), stat=stat)
      status = status_out_of_memory
      if (stat /= 0) return
      width = (1.0_wp - sqrt(1.0_wp - last / scale)) / real(panels, wp)
      table%per_panel = 1.0_wp / width
      angle = fit_angles()
      call copy_state(rest, here, status)
      if (status /= status_ok) return
      do i = 1, panels
         do k = 1, degree + 1
            w = width * (real(i, wp) - 0.5_wp + 0.5_wp * cos(angle(k)))
            call mechanism%carry_state(here, scale * w * (2.0_wp - w), status)
            if (status /= status_ok) return
            do j = 1, table%count
               both = ends(:, j)
               value(j, k) = measured(mechanism, here, sort(j), both, point(:, :, j))
            end do
         end do
         call fit_polynomials(angle, value, table%coefficient(:, :, i))
      end do
      status = status_ok
   end subroutine path_new

   !> One path at a state of the mechanism, zero at rest
   pure function measured(mechanism, state, sort, ends, point) result(u)
      type(linkage), intent(in) :: mechanism
      type(linkage_state), intent(in) :: state
      integer(c_int), intent(in) :: sort
      integer(c_int), intent(in) :: ends(2)
      real(wp), intent(in) :: point(2, 2)
      real(wp) :: u
      real(wp) :: at_rest(2), now(2), turn(2)
      integer :: k

      select case (sort)
      case (sort_length)
         at_rest = point(:, 2) - point(:, 1)
         now = part_place(mechanism, state, int(ends(2)), point(:, 2)) &
            - part_place(mechanism, state, int(ends(1)), point(:, 1))
         ! (l^2 - l0^2)/(l + l0) does not cancel
         u = dot_product(now - at_rest, now + at_rest) / (norm2(now) + norm2(at_rest))
      case default
         turn = 0.0_wp
         do k = 1, 2
            if (ends(k) > 0) turn(k) = state%place(3, ends(k))
         end do
         u = turn(1) - turn(2)
      end select
   end function measured

   !> One path and its derivative by q
   pure subroutine evaluate_path(table, path, q, u, du)
      class(path_table), intent(in) :: table
      integer, intent(in) :: path    !! its number
      real(wp), intent(in) :: q      !! [rad]
      real(wp), intent(out) :: u     !! [m] or [rad]
      real(wp), intent(out) :: du    !! by q
      real(wp) :: w, t, dw
      integer :: i, k

      ! trial steps may look past the end of the table: there the last panel goes on
      w = 1.0_wp - sqrt(max(1.0e-6_wp, 1.0_wp - q / table%scale))
      i = max(1, min(panels, 1 + int(w * table%per_panel)))
      t = max(lowest, min(-lowest, 2.0_wp * (w * table%per_panel - real(i - 1, wp)) - 1.0_wp))
      u = table%coefficient(path, degree, i)
      du = 0.0_wp
      do k = degree - 1, 0, -1
         du = du * t + u
         u = u * t + table%coefficient(path, k, i)
      end do
      dw = 0.5_wp / (table%scale * (1.0_wp - w))
      du = 2.0_wp * table%per_panel * dw * du
   end subroutine evaluate_path

   !> The flat list of a table
   pure subroutine path_pack(table, list)
      type(path_table), intent(in) :: table
      real(wp), intent(out) :: list(:)  !! (path_numbers(table%count))
      list(1:2) = [table%scale, table%per_panel]
      list(3:) = reshape(table%coefficient, [size(list) - 2])
   end subroutine path_pack

   !> A table of some paths from its flat list
   pure subroutine path_unpack(list, count, table, status)
      real(wp), intent(in) :: list(:)
      integer, intent(in) :: count
      type(path_table), intent(out) :: table
      integer(c_int), intent(out) :: status
      integer :: stat
      status = status_invalid_argument
      if (count < 1 .or. size(list) /= path_numbers(count)) return
      table%count = count
      table%scale = list(1)
      table%per_panel = list(2)
      if (.not. (table%scale > 0.0_wp .and. table%per_panel > 0.0_wp)) return
      allocate (table%coefficient(count, 0:degree, panels), stat=stat)
      status = merge(status_ok, status_out_of_memory, stat == 0)
      if (stat == 0) table%coefficient(:, :, :) = reshape(list(3:), [count, degree + 1, panels])
   end subroutine path_unpack

end module mechanism_path
