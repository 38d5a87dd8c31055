!> Linear programmes of few unknowns and many rows: the dual simplex method from vertex to vertex.
!>
!> HiGHS, from its last basis, takes 3 to 4 times as long for whole capacities (`python tests/bench solvers`).
module limit_vertex
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: least_vertex

   !> What rows may be broken by, and what multipliers may lack
   real(wp), parameter :: tolerance = 1.0e-10_wp
   !> Of the greatest share of a gradient in those of the vertex: less is no pivot
   real(wp), parameter :: no_pivot = 1.0e-9_wp
   !> Steps that gain nothing before the first index decides (Bland 1977), and steps between fresh inverses
   integer, parameter :: patience = 20, stale = 25

contains

   !> The x of least cost with a^T x >= b and low <= x <= high, and what the cost would grow by per unit of each bound.
   !>
   !> It starts at the vertex of the box that the cost requires, whose multipliers are not negative. Every step takes in
   !> the row that is broken most, and gives up the side whose multiplier vanishes first (Lemke 1954): the cost only
   !> grows, and where no row is broken it is least. Not solved where a row can be met by giving up no side (then no x
   !> obeys all), or where rounding prevents it: the caller uses another method.
   pure subroutine least_vertex(a, b, cost, low, high, x, rows, sides, solved, status)
      real(wp), intent(in) :: a(:, :)    !! (n, k) gradients of the rows
      real(wp), intent(in) :: b(:)       !! (k) least values
      real(wp), intent(in) :: cost(:)    !! (n)
      real(wp), intent(in) :: low(:)     !! (n) finite
      real(wp), intent(in) :: high(:)    !! (n) finite
      real(wp), intent(out) :: x(:)      !! (n)
      real(wp), intent(out) :: rows(:)   !! (k) multipliers of the rows, not negative
      real(wp), intent(out) :: sides(:)  !! (n) of the box: positive where x is at its least, negative at its greatest
      logical, intent(out) :: solved     !! false: another method must decide
      integer(c_int), intent(out) :: status  !! status_out_of_memory, else ok
      real(wp), allocatable :: inverse(:, :), lambda(:), share(:), bound(:), length(:), leaving(:), entering(:)
      real(wp), allocatable :: work(:, :), line(:)   ! of renew
      integer, allocatable :: active(:)
      real(wp) :: gain
      integer :: i, out, enters, step, idle, n, k, failed
      logical :: fresh

      n = size(cost)
      k = size(b)
      solved = .false.
      rows = 0.0_wp
      sides = 0.0_wp
      x = 0.0_wp
      allocate (inverse(n, n), lambda(n), share(n), bound(n), length(k), leaving(n), entering(n), work(n, 2 * n), &
         line(2 * n), active(n), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      do i = 1, k
         length(i) = max(norm2(a(:, i)), tiny(1.0_wp))
      end do
      ! Sides are numbered: rows 1 .. k, then least values of x, then greatest ones.
      inverse = 0.0_wp
      do i = 1, n
         active(i) = merge(k + i, k + n + i, cost(i) >= 0.0_wp)
         inverse(i, i) = merge(1.0_wp, -1.0_wp, cost(i) >= 0.0_wp)
         bound(i) = least(active(i))
      end do
      fresh = .true.
      idle = 0
      do step = 1, 50 * (n + 10)
         x = matmul(inverse, bound)
         lambda(:) = matmul(cost, inverse)
         enters = broken()
         if (enters == 0) then
            if (fresh) then
               solved = all(lambda > -tolerance * max(1.0_wp, maxval(abs(cost))))
               exit
            end if
            call renew_inverse(inverse, work, line, fresh)
            if (.not. fresh) return
            cycle
         end if
         call put_gradient(enters, entering)
         share(:) = matmul(entering, inverse)
         out = vanishing()
         if (out == 0) then
            if (fresh) return
            call renew_inverse(inverse, work, line, fresh)
            if (.not. fresh) return
            cycle
         end if
         gain = lambda(out) / share(out)
         idle = merge(0, idle + 1, gain > tolerance)
         leaving(:) = inverse(:, out) / share(out)
         do i = 1, n
            if (i /= out) inverse(:, i) = inverse(:, i) - share(i) * leaving
         end do
         inverse(:, out) = leaving
         active(out) = enters
         bound(out) = least(enters)
         fresh = .false.
         if (mod(step, stale) == 0) then
            call renew_inverse(inverse, work, line, fresh)
            if (.not. fresh) return
         end if
      end do
      if (.not. solved) return
      do i = 1, n
         gain = max(lambda(i), 0.0_wp)
         if (active(i) <= k) then
            rows(active(i)) = gain
         else if (active(i) <= k + n) then
            sides(active(i) - k) = sides(active(i) - k) + gain
         else
            sides(active(i) - k - n) = sides(active(i) - k - n) - gain
         end if
      end do

   contains

      !> Gradient of a side
      pure subroutine put_gradient(side, g)
         integer, intent(in) :: side
         real(wp), intent(out) :: g(:)
         if (side <= k) then
            g = a(:, side)
         else
            g = 0.0_wp
            if (side <= k + n) then
               g(side - k) = 1.0_wp
            else
               g(side - k - n) = -1.0_wp
            end if
         end if
      end subroutine put_gradient

      !> Least value of a side
      pure function least(side) result(value)
         integer, intent(in) :: side
         real(wp) :: value
         if (side <= k) then
            value = b(side)
         else if (side <= k + n) then
            value = low(side - k)
         else
            value = -high(side - k - n)
         end if
      end function least

      !> The side that is broken most, over the length of its gradient, or after many idle steps the first one; 0: none
      pure function broken() result(found)
         integer :: found, j
         real(wp) :: worst, lack
         found = 0
         worst = 0.0_wp
         do j = 1, k + 2 * n
            if (j <= k) then
               lack = b(j) - dot_product(a(:, j), x)
            else if (j <= k + n) then
               lack = low(j - k) - x(j - k)
            else
               lack = x(j - k - n) - high(j - k - n)
            end if
            if (lack <= tolerance) cycle
            if (j <= k) lack = lack / length(j)
            if (lack <= worst) cycle
            if (any(active == j)) cycle
            found = j
            if (idle > patience) return
            worst = lack
         end do
      end function broken

      !> Place in the vertex of the side whose multiplier vanishes first, of several the best pivot; 0 for none
      pure function vanishing() result(found)
         integer :: found, j
         real(wp) :: ratio, shortest, pivot
         found = 0
         shortest = huge(1.0_wp)
         pivot = 0.0_wp
         do j = 1, n
            if (share(j) <= no_pivot * maxval(abs(share))) cycle
            ratio = max(lambda(j), 0.0_wp) / share(j)
            if (ratio < shortest - tolerance) then
               found = j
            else if (ratio > shortest + tolerance) then
               cycle
            else if (idle > patience) then
               if (active(j) < active(found)) found = j
            else if (share(j) > pivot) then
               found = j
            end if
            if (found == j) then
               shortest = min(shortest, ratio)
               pivot = share(j)
            end if
         end do
      end function vanishing

      !> The inverse of the gradients of the vertex anew, by elimination with pivots; false where it has none
      pure subroutine renew_inverse(inverse, work, line, there)
         real(wp), intent(inout) :: inverse(:, :)
         real(wp), intent(out) :: work(:, :)
         real(wp), intent(out) :: line(:)
         logical, intent(out) :: there
         integer :: row, other, best
         work = 0.0_wp
         do row = 1, n
            call put_gradient(active(row), work(row, :n))
            work(row, n + row) = 1.0_wp
         end do
         there = .false.
         do row = 1, n
            best = row - 1 + maxloc(abs(work(row:, row)), 1)
            if (abs(work(best, row)) < tiny(1.0_wp)) return
            line = work(best, :) / work(best, row)
            work(best, :) = work(row, :)
            work(row, :) = line
            do other = 1, n
               if (other /= row) work(other, :) = work(other, :) - work(other, row) * line
            end do
         end do
         inverse = work(:, n + 1:)
         there = .true.
      end subroutine renew_inverse

   end subroutine least_vertex

end module limit_vertex
