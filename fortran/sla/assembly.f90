!> The stiffness matrix on a pattern that never changes: lower triangle by columns, 0-based as C reads it.
module sla_assembly
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use sla_group, only : group_holder, event_vectors, most_entries
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: build_pattern, assemble, add_event, position

contains

   !> Pattern of the equations of all elements
   subroutine build_pattern(holders, n, start, row, status)
      type(group_holder), intent(in) :: holders(:)
      integer, intent(in) :: n                               !! equations
      integer(c_int64_t), allocatable, intent(out) :: start(:)  !! (n + 1)
      integer(c_int64_t), allocatable, intent(out) :: row(:)
      integer(c_int), intent(out) :: status
      integer, allocatable :: first(:), element(:), group(:), seen(:), found(:)
      integer(c_int64_t), allocatable :: longer(:)
      integer :: g, e, i, j, k, column, count, info, equation
      integer(c_int64_t) :: used

      status = status_out_of_memory
      allocate (first(n + 2), seen(n), found(n), start(n + 1), stat=info)
      if (info /= 0) return
      first = 0
      do g = 1, size(holders)
         do e = 1, holders(g)%group%elements
            do i = 1, holders(g)%group%freedoms
               equation = holders(g)%group%equation(i, e)
               if (equation > 0 .and. equation <= n) first(equation + 2) = first(equation + 2) + 1
            end do
         end do
      end do
      first(1:2) = 1
      do i = 3, n + 2
         first(i) = first(i) + first(i - 1)
      end do
      allocate (element(first(n + 2)), group(first(n + 2)), row(16 * int(n, c_int64_t) + 64), stat=info)
      if (info /= 0) return
      do g = 1, size(holders)
         do e = 1, holders(g)%group%elements
            do i = 1, holders(g)%group%freedoms
               equation = holders(g)%group%equation(i, e)
               if (equation == 0 .or. equation > n) cycle
               element(first(equation + 1)) = e
               group(first(equation + 1)) = g
               first(equation + 1) = first(equation + 1) + 1
            end do
         end do
      end do
      seen = 0
      used = 0
      do column = 1, n
         start(column) = used
         count = 1
         found(1) = column     ! the diagonal exists even where no element touches the equation
         seen(column) = column
         do k = first(column), first(column + 1) - 1
            associate (touching => holders(group(k))%group)
               do i = 1, touching%freedoms
                  equation = touching%equation(i, element(k))
                  if (equation <= column .or. equation > n) cycle
                  if (seen(equation) == column) cycle
                  seen(equation) = column
                  count = count + 1
                  found(count) = equation
               end do
            end associate
         end do
         if (used + count > size(row)) then
            allocate (longer(2 * size(row) + count), stat=info)
            if (info /= 0) return
            longer(1:used) = row(1:used)
            call move_alloc(longer, row)
         end if
         do i = 2, count
            equation = found(i)
            j = i - 1
            do while (j >= 1)
               if (found(j) <= equation) exit
               found(j + 1) = found(j)
               j = j - 1
            end do
            found(j + 1) = equation
         end do
         row(used + 1:used + count) = found(1:count) - 1
         used = used + count
      end do
      start(n + 1) = used
      status = status_ok
   end subroutine build_pattern

   !> Where entry (i, j), i >= j, both 1-based, is stored
   pure function position(start, row, i, j) result(at)
      integer(c_int64_t), intent(in) :: start(:)
      integer(c_int64_t), intent(in) :: row(:)
      integer, intent(in) :: i
      integer, intent(in) :: j
      integer(c_int64_t) :: at, low, high
      low = start(j) + 1
      high = start(j + 1)
      do while (low < high)
         at = (low + high) / 2
         if (row(at) < i - 1) then
            low = at + 1
         else
            high = at
         end if
      end do
      at = low
   end function position

   !> Values of the whole matrix
   pure subroutine assemble(holders, start, row, value)
      type(group_holder), intent(in) :: holders(:)
      integer(c_int64_t), intent(in) :: start(:)
      integer(c_int64_t), intent(in) :: row(:)
      real(wp), intent(out) :: value(:)
      real(wp) :: k(most_entries, most_entries)
      integer :: g, e, i, j, n, row_equation, column_equation
      integer(c_int64_t) :: at

      n = size(start) - 1
      value = 0.0_wp
      do g = 1, size(holders)
         associate (group => holders(g)%group)
            do e = 1, group%elements
               call group%matrix(e, k)
               do j = 1, group%freedoms
                  column_equation = group%equation(j, e)
                  if (column_equation == 0 .or. column_equation > n) cycle
                  do i = 1, group%freedoms
                     row_equation = group%equation(i, e)
                     if (row_equation < column_equation .or. row_equation > n) cycle
                     at = position(start, row, row_equation, column_equation)
                     value(at) = value(at) + k(i, j) * group%factor(i, e) * group%factor(j, e)
                  end do
               end do
            end do
         end associate
      end do
   end subroutine assemble

   !> The change of one event in the stored values
   pure subroutine add_event(event, start, row, value)
      type(event_vectors), intent(in) :: event
      integer(c_int64_t), intent(in) :: start(:)
      integer(c_int64_t), intent(in) :: row(:)
      real(wp), intent(inout) :: value(:)
      integer :: i, j
      integer(c_int64_t) :: at
      do j = 1, event%entries
         if (event%index(j) > size(start) - 1) cycle
         do i = 1, event%entries
            if (event%index(i) < event%index(j) .or. event%index(i) > size(start) - 1) cycle
            at = position(start, row, int(event%index(i)), int(event%index(j)))
            value(at) = value(at) - sum(event%sign(1:event%rank) * event%w(i, 1:event%rank) * event%w(j, 1:event%rank))
         end do
      end do
   end subroutine add_event

end module sla_assembly
